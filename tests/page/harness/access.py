# SPDX-License-Identifier: Apache-2.0
"""Can everybody use the page? Contrast of each text, a name for each control, and where the keyboard leads."""

CONTROLS = ("button", "link", "checkbox", "textbox", "slider", "combobox", "tab", "option", "tabpanel", "dialog",
            "alertdialog", "table", "toolbar", "searchbox", "listbox", "image")

# Texts that can be read, each with its contrast to what is behind it: [ratio, text, place]. Colours are blended over
# all that lies behind; the least of the ratios counts for a text of the picture, which may lie on a box or beside it.
CONTRASTS = """
const rgba = (text) => {
  const parts = text.match(/[\\d.]+/g).map(Number);
  return text.startsWith('rgb') ? [parts[0], parts[1], parts[2], parts[3] ?? 1] : null;
};
const over = (top, under) => [0, 1, 2].map((i) => top[i] * top[3] + under[i] * (1 - top[3])).concat(1);
const light = (colour) => {
  const [r, g, b] = colour.map((c) => c / 255).map((c) => (c <= 0.03928 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4));
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
};
const ratio = (a, b) => {
  const [high, low] = [light(a), light(b)].sort((x, y) => y - x);
  return (high + 0.05) / (low + 0.05);
};
const paper = rgba(getComputedStyle(document.body).backgroundColor);
const opacity = (e) => (e ? Number(getComputedStyle(e).opacity) * opacity(e.parentElement) : 1);
const behind = (e) => {
  const layers = [];
  for (; e; e = e.parentElement) layers.push(rgba(getComputedStyle(e).backgroundColor));
  return layers.reverse().reduce((under, top) => over(top, under), [255, 255, 255, 1]);
};
const box = document.querySelector('.box .frame');
const boxes = () => (box ? [over(rgba(getComputedStyle(box).fill), paper)] : []);
const grounds = (e) => (e.ownerSVGElement ? [behind(e.ownerSVGElement), ...boxes()] : [behind(e)]);
const found = [];
const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
while (walker.nextNode()) {
  const text = walker.currentNode.textContent.trim(), e = walker.currentNode.parentElement;
  if (text === '' || !e.getClientRects().length || ['SCRIPT', 'NOSCRIPT', 'OPTION'].includes(e.tagName)) continue;
  const style = getComputedStyle(e);
  if (style.visibility !== 'visible') continue;
  const colour = rgba(e.ownerSVGElement ? style.fill : style.color);
  const seen = (ground) => ratio(over([colour[0], colour[1], colour[2], colour[3] * opacity(e)], ground), ground);
  found.push([Math.min(...grounds(e).map(seen)), text, e.tagName + '.' + (e.getAttribute('class') ?? '')]);
}
for (const e of document.querySelectorAll('input:not([type=range]):not([type=checkbox]), select')) {
  if (e.getClientRects().length)
    found.push([ratio(over(rgba(getComputedStyle(e).color), behind(e)), behind(e)), e.value, e.tagName]);
}
return found;
"""


def unnamed(browser):
    """Controls without a name, as a screen reader is given them."""
    tree = browser.command("Accessibility.getFullAXTree")["nodes"]
    roles = [(node.get("role", {}).get("value"), node.get("name", {}).get("value", "").strip(), node)
             for node in tree if not node.get("ignored")]
    assert any(role == "button" for role, _, _ in roles), "the tree of the screen reader is empty"
    return [f"{role}: {node.get('properties')}" for role, name, node in roles if role in CONTROLS and not name]


def faint(browser, least=4.5):
    """Texts whose contrast is below `least`."""
    found = browser.driver.execute_script(CONTRASTS)
    assert len(found) > 20, found
    return sorted({f"{ratio:.2f}: '{text[:40]}' {place}" for ratio, text, place in found if ratio < least})
