# SPDX-License-Identifier: Apache-2.0
"""Proves that no class of chimera/ (production sources, nested and local classes too) has more than about 25 functions:
what it declares counts, private, static and one-line ones, each overload for itself; constructors, destructors, friends
and what is `= default` or `= delete` do not."""
import pathlib
import re
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parent / "check"))
import sources  # noqa: E402
from check_class_names import DEFINITION, NAMESPACE, TEST, blanked  # noqa: E402

LIMIT = 27
GROUP = "\1"  # stands for (...)
LABEL = re.compile(r"^\s*(?:(?:public|protected|private)\s*:(?!:)\s*)+")
TEMPLATE = re.compile(r"^template\s*<(?:[^<>]|<[^<>]*>)*>\s*")
OPERATOR = re.compile(rf"\boperator\s*(?:{GROUP}|\[\]|[^\w\s{GROUP}]+)")
NO_NAME = re.compile(rf"\b(?:alignas|noexcept|decltype|requires|explicit|sizeof|__attribute__)\s*{GROUP}|\[\[[^]]*\]\]")
NO_FUNCTION = re.compile(r"(?:friend|using|typedef|static_assert|enum|template\s+class)\b|,")
CALLED = re.compile(rf"(~?\w+)\s*{GROUP}")


def without_groups(content):
    """Each outermost (...) as one character; every line where it was."""
    out, depth = [], 0
    for char in content:
        depth += char == "("
        if depth == 0 or char == "\n":
            out.append(char)
        elif char == ")":
            depth -= 1
            out.append(GROUP if depth == 0 else "")
    return "".join(out)


def declares_function(head):
    """Does a member declaration, up to its ';' or '{', declare a function that counts?"""
    head = LABEL.sub("", head).strip()
    head = TEMPLATE.sub("", head)
    if NO_FUNCTION.match(head) or re.search(r"=\s*(?:default|delete)\s*$", head):
        return False
    head = NO_NAME.sub(" ", OPERATOR.sub(" operator_ ", head)).replace("->", "  ").strip()
    for match in CALLED.finditer(head):
        before = head[:match.start()]
        if before.count("<") != before.count(">"):  # an argument of a template
            continue
        is_variable = "=" in before or head[match.end():].lstrip().startswith(GROUP)  # f = g(), void (*f)()
        is_constructor = not before.strip(" \n") or match[1].startswith("~") or re.fullmatch(
            r"(?:\s|inline|constexpr|consteval|virtual|explicit)*", before)
        return not is_variable and (not is_constructor or match[1] == "operator_")
    return False


def classes(content):
    """(line, name, functions) of every class and struct."""
    content = without_groups(blanked(content))
    scopes, start = [], 0  # of each open brace: [line, name, functions] of a class, else None
    for match in re.finditer(r"[{};]", content):
        head = content[start:match.start()]
        start = match.end()
        inside = scopes[-1] if scopes else None
        if match[0] == "}":
            if scopes and scopes.pop():
                yield tuple(inside)
            continue
        stripped = LABEL.sub("", head).strip()
        found = DEFINITION.search(stripped) if match[0] == "{" and not NAMESPACE.search(head.rstrip()) else None
        if inside and not found and declares_function(head):
            inside[2] += 1
        if match[0] == "{":
            is_class = found and not re.search(r"\benum\b", stripped)
            scopes.append([content.count("\n", 0, match.start()) + 1, found[1], 0] if is_class else None)


def check(root):
    for name in sources.files(root):
        if name.startswith("chimera/") and name.endswith((".h", ".cc")) and not TEST.search(name):
            for line, found, functions in classes(sources.text(root, name)):
                if functions > LIMIT:
                    yield f"{name}:{line}: {found} has {functions} functions, at most {LIMIT} are allowed"


def _tree(declarations, n=LIMIT, name="chimera/base/x.h"):
    """A class of `n` plain functions and `declarations`."""
    plain = "".join(f"  void f{i}();\n" for i in range(n))
    body = f" public:\n{plain} private:\n{declarations}"
    return {name: f"namespace chimera {{\nclass X final : public Y {{\n{body}}};\n}}\n"}


def _over(more=1):
    return f"chimera/base/x.h:2: X has {LIMIT + more} functions, at most {LIMIT} are allowed"


PLANTED = (
    (_tree(""), None),
    (_tree("  int one() const noexcept { return g({1, 2}); }\n"), _over()),
    (_tree("  static int one(int n = h(3), T t = {}) noexcept;\n  int one(\n      char c);\n"), _over(2)),
    (_tree("  template <class T = int>\n  auto one(T t) const -> int { if (t) { go(); } return 1; }\n"), _over()),
    (_tree("  X& operator()(int n);\n  bool operator==(const X& o) const;\n  operator bool() const { return 1; }\n"),
     _over(3)),
    (_tree("  virtual std::function<void(int)> one(std::span<int> s) = 0;\n"), _over()),
    (_tree("  X();\n  explicit X(int n) noexcept : a_{n}, b_(n) { go(); }\n  virtual ~X();\n  X(X&&) = delete;\n"
           "  X& operator=(const X&) = delete;\n  bool operator==(const X&) const = default;\n"), None),
    (_tree("  friend bool one(const X& x) { return two(x); }\n  friend class Z;\n  using F = void (*)(int);\n"), None),
    (_tree("  int n_ = one();\n  int m_{two()};\n  void (*call_)(int) = nullptr;\n  std::function<void(int)> f_;\n"
           "  alignas(64) std::atomic<bool> b_{false};\n  // void comment();\n"
           "  static_assert(sizeof(int) == 4);\n"), None),
    (_tree("  enum class E { kOne, kTwo };\n  struct In { int f() { return 1; } int n = 0; };\n"), None),
    ({"chimera/base/x.cc": "namespace chimera {\nvoid f() {\n  struct L {" + " int g() {}" * 28 + "};\n}\n}"},
     "chimera/base/x.cc:3: L has 28 functions, at most 27 are allowed"),
    (_tree("  void one();\n", name="chimera/base/testing/x.h"), None),
    (_tree("  void one();\n", name="chimera/base/x_test.cc"), None),
)

if __name__ == "__main__":
    sources.run(check, PLANTED)
