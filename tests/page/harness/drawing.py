# SPDX-License-Identifier: Apache-2.0
"""The picture of the page beside that of `chimera check FILE --graph svg`."""
import subprocess
import xml.etree.ElementTree as xml

from web import BUILD

SVG = "{http://www.w3.org/2000/svg}"
DRAWN = """
const at = (e, names) => names.map((name) => Number(e.getAttribute(name)));
const all = (selector, take) => [...document.querySelectorAll('svg.picture ' + selector)].map(take);
return {
  boxes: all('rect.frame', (e) => at(e, ['x', 'y', 'width', 'height'])),
  lines: all('.drawing line', (e) => at(e, ['x1', 'y1', 'x2', 'y2'])),
  dots: all('.drawing circle', (e) => at(e, ['cx', 'cy'])),
  texts: all('.labels text', (e) => [e.textContent, ...at(e, ['x', 'y'])])};"""


def expect_that_of_check(test, file, boxes):
    """The page of the test draws FILE as the command does. `boxes`: how many."""
    done = subprocess.run([BUILD / "bin" / "chimera", "check", file, "--graph", "svg"], capture_output=True, text=True,
                          check=True, cwd=file.parent)
    root, drawn = xml.fromstring(done.stdout), test.page.script(DRAWN)

    def all_of(tag, *names, attribute=None):
        return [[float(e.get(name)) for name in names] for e in root.iter(SVG + tag)
                if attribute is None or e.get(attribute)]

    test.assertEqual(len(drawn["boxes"]), boxes)
    test.assertCountEqual(drawn["boxes"], all_of("rect", "x", "y", "width", "height", attribute="rx"))
    test.assertCountEqual(drawn["lines"], all_of("line", "x1", "y1", "x2", "y2"))
    test.assertCountEqual(drawn["dots"], all_of("circle", "cx", "cy"))
    texts = [[e.text, float(e.get("x")), float(e.get("y"))] for e in root.iter(SVG + "text")]
    test.assertGreater(len(drawn["texts"]), 2 * boxes)
    for text in drawn["texts"]:
        test.assertIn(text, texts)
