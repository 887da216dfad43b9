"""Mutant schemata: writes a copy of the headers in which every operator, factor, index, statement and
so on of a suite's headers can be switched to a wrong one at run time (proxies.hpp, README.md).

    instrument.py <include folder> <output folder> <suite>

The copy has the same lines. The list of mutants goes to <output folder>/mutants.json. In that folder
may lie dropped.txt, lines <header>:<line> to leave alone, and only.txt, the headers to break; all of
the suite where it is missing.
"""

import argparse
import collections
import json
import pathlib
import re

# Compiled once instead of at every call: the compiler is what this run waits for.
SHORTER = {
    "#define CROSSBEAM_INLINE [[gnu::always_inline]] inline": "#define CROSSBEAM_INLINE inline",
    "#define CROSSBEAM_INLINE_LAMBDA __attribute__((always_inline))":
        "#define CROSSBEAM_INLINE_LAMBDA",
}
# Every folder that computes belongs to one suite: a copy of the headers, and the tests that judge it.
SUITES = {
    "kernels": ("kinematics", "cell", "law", "element"),
    "assembly": ("base", "tools", "contact", "mesh", "model", "sweep", "dynamics", "simulation"),
}
# Adapters need a library of others, and the verification's own headers are tests.
FOLDERS_LEFT_ALONE = ("adapters", "verification")
# Refusals and names, no arithmetic.
HEADERS_LEFT_ALONE = ("crossbeam/base/error.hpp", "crossbeam/base/version.hpp")
SITES_OF_A_HEADER = 2000
SCALAR = "crossbeam/base/scalar.hpp"
KEYWORDS = {"auto", "break", "case", "const", "constexpr", "continue", "decltype", "default", "delete",
            "do", "else", "for", "goto", "if", "new", "operator", "return", "static", "struct", "switch",
            "template", "throw", "typename", "using", "while"}

TOKEN = re.compile(
    r"""(?P<space>\s+)
      | (?P<comment>//[^\n]*|/\*.*?\*/)
      | (?P<directive>(?<![^\n])\#(?:[^\n]*\\\n)*[^\n]*)
      | (?P<text>"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])*')
      | (?P<number>(?:\d[\d']*\.?\d*|\.\d+)(?:[eE][+-]?\d+)?[a-zA-Z]*)
      | (?P<name>[A-Za-z_]\w*)
      | (?P<sign>->\*|<<=|->|::|\+\+|--|<<|<=|>=|==|!=|&&|\|\||\+=|-=|\*=|/=|%=|.)""",
    re.VERBOSE | re.DOTALL)

# Binary operators: the proxy, and what each variant reads like (None: the operand is left out).
BINARY = {
    "+": ("Add", ["-", None]),
    "-": ("Sub", ["+", None]),
    "*": ("Mul", ["/", None]),
    "/": ("Div", ["*", None]),
    "<": ("Less", ["<=", ">="]),
    "<=": ("LessEqual", ["<", ">"]),
    ">": ("Greater", [">=", "<="]),
    ">=": ("GreaterEqual", [">", "<"]),
    "==": ("Equal", ["!="]),
    "!=": ("NotEqual", ["=="]),
    "%": ("Mod", ["/", None]),
    "&": ("BitAnd", ["|", None]),
    "|": ("BitOr", ["&", None]),
    "<<": ("ShiftLeft", [">>", None]),
    ">>": ("ShiftRight", ["<<", None]),
}
LOOP = {
    "<": ("LoopLess", ["+ 1 <", "no turn: <"]),
    "<=": ("LoopLessEqual", ["<", "no turn: <="]),
    ">=": ("LoopGreaterEqual", [">", "no turn: >="]),
}
PRECEDENCE = {"*": 10, "/": 10, "%": 10, "+": 9, "-": 9, "<<": 8, ">>": 8, "<": 7, "<=": 7, ">": 7,
              ">=": 7, "==": 6, "!=": 6, "&": 5, "|": 3, "&&": 2, "||": 1}
KIND = {"+": "sign", "-": "sign", "*": "factor", "/": "factor", "<": "comparison",
        "<=": "comparison", ">": "comparison", ">=": "comparison", "==": "comparison",
        "!=": "comparison", "%": "factor", "&": "logic", "|": "logic",
        "<<": "factor", ">>": "factor"}
DECIDES = {"<", "<=", ">", ">=", "==", "!=", "&&", "||"}

FUNCTIONS = {
    "maximum": ("Maximum", "minimum"), "minimum": ("Minimum", "maximum"),
    "select": ("Select", "select_other"), "cos": ("Cos", "sin"), "sin": ("Sin", "cos"),
    "sqrt": ("Sqrt", ""), "cbrt": ("Cbrt", ""), "magnitude": ("Magnitude", ""),
    "cross": ("Cross", "cross_back"), "all": ("All", "any"), "any": ("Any", "all"),
    "ceil": ("Ceil", "floor"), "floor": ("Floor", "ceil"),
}
STD_FUNCTIONS = {"max": ("StdMax", "min"), "min": ("StdMin", "max"), "abs": ("Abs", ""),
                 "hypot": ("Hypot", ""), "sqrt": ("Sqrt", ""), "ceil": ("Ceil", "floor"),
                 "floor": ("Floor", "ceil"), "min_element": ("MinElement", "max_element"),
                 "max_element": ("MaxElement", "min_element"),
                 "upper_bound": ("UpperBound", "lower_bound"),
                 "lower_bound": ("LowerBound", "upper_bound")}

TWINS = {}
for pair in ("c s", "c0 s0", "warp weft", "L H", "Lc h", "ka kb", "along across", "ahead behind",
             "hh Lh", "LL hh", "cosine sine", "a_ b_", "xi eta", "sx sy", "x y", "z y", "x_ y_", "i j",
             "nx ny", "x0 x1", "y0 y1", "h_x h_y", "flat_x_ flat_y_", "along_x along_y",
             "cell_x cell_y", "on_x on_y", "fix_x fix_y", "rows columns", "row column", "low high",
             "first last", "begin end", "width length", "v_minus v_plus", "v v_predicted",
             "friction damping", "friction_power damping_power", "friction_z damping_z",
             "position velocity", "above below", "stored dissipated"):
    one, other = pair.split()
    TWINS.setdefault(one, other)
    TWINS.setdefault(other, one)
# As local names they are functions or iterators of another kind.
MEMBERS_ONLY = [{"row", "column"}, {"first", "last"}]
NUMBERED = re.compile(r"(?P<stem>[A-Za-z_]*?[A-Za-z])(?P<index>11|22|33|12|13|23|1|2)(?P<end>_?)$")
OTHER_INDEX = {"1": "2", "2": "1", "11": "22", "22": "11", "12": "11", "13": "23", "23": "13",
               "33": "22"}


def twin_of(name, member=False):
    """member: after a dot, where nothing says that the twin exists."""
    if name in TWINS and not (member and len(name) == 1 and name in "cs"):
        return TWINS[name]
    match = NUMBERED.match(name)
    if match:
        return match["stem"] + OTHER_INDEX[match["index"]] + match["end"]
    return None


class Members(set):
    """Names that a class declares, and the header where."""
    header = ""


class Token:
    __slots__ = ("kind", "text", "line", "before", "after", "live", "index", "loop", "insert",
                 "ahead", "behind", "classes", "constant")

    def __init__(self, kind, text, line):
        self.kind, self.text, self.line = kind, text, line
        self.before = self.after = False  # white space beside it
        self.live = False   # may be mutated
        self.index = False  # inside square brackets
        self.loop = False   # in the condition of a for loop
        self.insert = None  # instrumented text
        self.ahead = self.behind = ""  # what stands before and after it
        self.constant = False  # in a function that may be evaluated by the compiler
        self.classes = ()   # the scopes it stands in, each the set of names declared there


def tokenize(source):
    tokens, line, space = [], 1, True
    raw = []
    for match in TOKEN.finditer(source):
        raw.append((match.lastgroup, match.group(), line))
        line += match.group().count("\n")
    for kind, text, number in raw:
        if kind in ("space", "comment", "directive"):
            if tokens:
                tokens[-1].after = True
            space = True
        else:
            token = Token(kind, text, number)
            token.before = space
            space = False
            tokens.append(token)
    return raw, tokens


def matching(tokens, i, open_sign, close_sign):
    depth = 0
    for j in range(i, len(tokens)):
        if tokens[j].text == open_sign:
            depth += 1
        elif tokens[j].text == close_sign:
            depth -= 1
            if depth == 0:
                return j
    raise ValueError(f"line {tokens[i].line}: {open_sign} without {close_sign}")


def template_end(tokens, i):
    """The closing bracket of template arguments that open at i, or None where it is a comparison."""
    if tokens[i].before or i == 0 or tokens[i - 1].kind != "name":
        return None
    depth = 0
    for j in range(i, len(tokens)):
        text = tokens[j].text
        if text == "<":
            depth += 1
        elif text == ">":
            depth -= 1
            if depth == 0:
                return j
        elif text in (";", "{", "&&", "||"):
            return None
    return None


def mark(tokens, all_classes=None):
    """Sets `live` in the bodies of functions and in the initialisers of constructors, outside what
    is decided at compile time and outside refusals of input. The names that each class declares are
    added to `all_classes`."""
    stack, header, i, classes, in_constexpr = [], [], 0, [], 0
    while i < len(tokens):
        token = tokens[i]
        token.classes = tuple(classes)
        function = bool(stack) and stack[-1] in ("function", "block", "constexpr")
        token.constant = in_constexpr > 0
        if token.text == "{":
            texts = [t.text for t in header]
            if function:
                stack.append("block")
            elif "requires" in texts and is_requires_expression(header):
                i = matching(tokens, i, "{", "}") + 1
                continue
            elif {"namespace", "struct", "class", "enum", "union"} & set(without_templates(texts)):
                stack.append("scope")
                classes.append(Members())
                if all_classes is not None:
                    all_classes.append(classes[-1])
            elif "(" in texts and "concept" not in texts:
                if {"constexpr", "consteval"} & set(texts):
                    stack.append("constexpr")
                    in_constexpr = len(stack)
                else:
                    stack.append("function")
                    mark_initialisers(header)
            else:
                i = matching(tokens, i, "{", "}") + 1  # the initialiser of a member
                continue
            header = []
        elif token.text == "}":
            if len(stack) == in_constexpr:
                in_constexpr = 0
            if stack and stack.pop() == "scope":
                classes.pop()
            header = []
        elif token.text in (";",) or (token.text == ":" and header and
                                      header[-1].text in ("public", "private", "protected")):
            if not function:
                if classes and not {"(", "using", "friend"} & {t.text for t in header}:
                    classes[-1] |= {t.text for t in header if t.kind == "name"}
                header = []
        else:
            header.append(token)
            token.live = function
        i += 1

    skip_compile_time(tokens)
    skip_statements(tokens)
    mark_loops(tokens)


def is_requires_expression(header):
    depth = 0
    for j in range(len(header) - 1, -1, -1):
        if header[j].text == ")":
            depth += 1
        elif header[j].text == "(":
            depth -= 1
        elif depth == 0:
            return header[j].text == "requires"
    return False


def without_templates(texts):
    """The words of a header without `template <class T>`."""
    out, depth = [], 0
    for k, text in enumerate(texts):
        if text == "<" and (depth or (k and texts[k - 1] == "template")):
            depth += 1
        elif text == ">" and depth:
            depth -= 1
        elif not depth:
            out.append(text)
    return out


def mark_initialisers(header):
    depth = 0
    for j, token in enumerate(header):
        if token.text == "(":
            depth += 1
        elif token.text == ")":
            depth -= 1
        elif token.text == ":" and depth == 0 and j and header[j - 1].text == ")":
            for t in header[j + 1:]:
                t.live = True
            return


def skip(tokens, first, last):
    for token in tokens[first:last + 1]:
        token.live = False


def skip_compile_time(tokens):
    i = 0
    while i < len(tokens):
        token = tokens[i]
        if token.text == "<":
            end = template_end(tokens, i)
            if end is not None:
                skip(tokens, i, end)
                i = end
        elif token.live and token.text == "constexpr" and tokens[i - 1].text == "if":
            skip(tokens, i + 1, matching(tokens, i + 1, "(", ")"))
        elif token.live and token.text == "decltype":
            skip(tokens, i + 1, matching(tokens, i + 1, "(", ")"))
        elif token.live and token.text == "requires" and tokens[i + 1].text == "{":
            skip(tokens, i, matching(tokens, i + 1, "{", "}"))
        i += 1


def skip_statements(tokens):
    first = 0
    for i, token in enumerate(tokens):
        if token.text in (";", "{", "}"):
            words = {t.text for t in tokens[first:i]}
            if words & {"throw", "using", "static_assert", "static", "typedef", "CROSSBEAM_EXPECTS"}:
                skip(tokens, first, i)
            if "constexpr" in words and words & {"int", "bool", "auto", "std"} and "if" not in words:
                skip(tokens, first, i)  # it may be the size of an array
            first = i + 1


def mark_loops(tokens):
    depth = 0
    for i, token in enumerate(tokens):
        if token.text == "[":
            depth += 1
        elif token.text == "]":
            depth -= 1
        token.index = depth > 0
        if token.text == "for" and tokens[i + 1].text == "(":
            end, part = matching(tokens, i + 1, "(", ")"), 0
            for t in tokens[i + 1:end]:
                part += t.text == ";"
                t.loop = part == 1
                if part == 2:
                    t.live = False  # without its step a loop does not end
        elif token.text == "case" and tokens[i + 2].text == ":":
            tokens[i + 1].live = False


class Instrumenter:
    def __init__(self, name, source, first_site, dropped, members=()):
        """members: the Members of every class."""
        self.name, self.source, self.members = name, source, members
        self.lines = source.split("\n")
        self.site = first_site
        self.dropped = dropped
        self.mutants = []
        self.raw, self.tokens = tokenize(source)
        own = []
        mark(self.tokens, own)
        for c in own:
            c.header = name
        self.members = self.members or own

    def add(self, token, kind, variants):
        """variants: (before, after) each. Returns the number of the site, negative where the compiler
        may evaluate it, or None on a line that does not compile with mutants."""
        if token.line in self.dropped:
            return None
        self.site += 1
        for k, (before, after) in enumerate(variants, 1):
            self.mutants.append({"site": self.site, "variant": k, "file": self.name,
                                 "line": token.line, "kind": kind, "before": before,
                                 "after": after,
                                 "text": self.lines[token.line - 1].strip()})
        return -self.site if token.constant else self.site

    def right_operand(self, i):
        """Words of the right operand of the binary operator at i, for the reader."""
        own, depth, words = PRECEDENCE[self.tokens[i].text], 0, []
        for token in self.tokens[i + 1:]:
            if token.text in "([{":
                depth += 1
            elif token.text in ")]}":
                depth -= 1
                if depth < 0:
                    break
            elif depth == 0:
                if token.text in (",", ";", "?", ":"):
                    break
                if token.before and token.after and PRECEDENCE.get(token.text, 99) <= own:
                    break
            words.append(spelled(token, bool(words)))
        return "".join(words)

    def left_word(self, i):
        """The last words before i, for the reader."""
        words, depth = [], 0
        for token in reversed(self.tokens[:i]):
            if token.text in ")]":
                depth += 1
            elif token.text in "([":
                depth -= 1
                if depth < 0:
                    break
            elif depth == 0 and (token.text in ",;{}?:<>=" or token.text == "return"):
                break
            words.append((" " if token.before else "") + token.text)
            if depth == 0 and token.before:
                break
        return "".join(reversed(words)).strip()

    def binary(self, i):
        token = self.tokens[i]
        if token.text not in BINARY or not (token.before and token.after):
            return
        previous = self.tokens[i - 1]
        if previous.text in ("(", ",", "return", "operator", "=", "{", ";", "<<", "]>", "?", ":"):
            return
        if "text" in (previous.kind, self.tokens[i + 1].kind):
            return  # the words of a message
        loop = token.loop and token.text in LOOP
        proxy, changes = (LOOP if loop else BINARY)[token.text]
        left, right = self.left_word(i), self.right_operand(i)
        if token.index and token.text in ("+", "-"):
            changes = [None, None]  # the changed sign would read beyond the array
        variants = []
        for change in changes:
            after = left if change is None else f"{left} {change} {right}"
            variants.append((f"{left} {token.text} {right}", after))
        kind = "loop" if loop else KIND[token.text]
        site = self.add(token, kind, variants)
        if site is None:
            return
        for mutant, change in zip(self.mutants[-len(variants):], changes):
            if change is None:
                mutant["kind"] = "dropped term" if token.text in "+-" else "dropped factor"
        if token.index and token.text in ("+", "-"):
            first = self.mutants.pop(-2)
            self.mutants[-1]["variant"] = 2
            del first
        token.insert = f"{token.text} mutation::{proxy}{{{site}}} {token.text}"

    def connective(self, i):
        """`a && b` without one of its conditions. What stands behind a condition that does not hold
        is still not looked at."""
        token, t = self.tokens[i], self.tokens
        if token.text not in ("&&", "||") or not (token.before and token.after) or \
                self.guards_pointer(i):
            return
        first, last = self.operand_before(i), self.operand_behind(i)
        left, right = self.words(first, i - 1), self.words(i + 1, last)
        written = f"{left} {token.text} {right}"
        site = self.add(token, "dropped condition", [(written, right), (written, left)])
        if site is None:
            return
        name, connect = {"&&": ("True", "||"), "||": ("False", "&&")}[token.text]
        for which, begin, end in ((1, first, i - 1), (2, i + 1, last)):
            t[begin].ahead = f"(mutation::{name}{{{site}, {which}}} {connect} (" + t[begin].ahead
            t[end].behind += "))"

    def operand_before(self, i):
        """First token of the left operand of the operator at i."""
        t, depth, own = self.tokens, 0, PRECEDENCE[self.tokens[i].text]
        for j in range(i - 1, -1, -1):
            text = t[j].text
            depth += (text in (")", "]", "}")) - (text in ("(", "[", "{"))
            if depth < 0 or depth == 0 and (
                    text in ("=", ",", ";", "return", "?", ":", "+=", "|=", "&=") or
                    t[j].before and t[j].after and PRECEDENCE.get(text, 99) < own):
                return j + 1
        return 0

    def operand_behind(self, i):
        """Last token of the right operand of the operator at i."""
        t, depth, own = self.tokens, 0, PRECEDENCE[self.tokens[i].text]
        for j in range(i + 1, len(t)):
            text = t[j].text
            depth += (text in ("(", "[", "{")) - (text in (")", "]", "}"))
            if depth < 0 or depth == 0 and (
                    text in (",", ";", "?", ":") or
                    t[j].before and t[j].after and PRECEDENCE.get(text, 99) <= own):
                return j - 1
        return len(t) - 1

    def guards_pointer(self, i):
        """One side may protect the dereference of a pointer on the other."""
        for step in (-1, 1):
            j = i
            while 0 <= j < len(self.tokens) and self.tokens[j].text not in (";", "{", "}"):
                if self.tokens[j].text == "->":
                    return True
                j += step
        return False

    def prefix(self, i):
        token = self.tokens[i]
        previous = self.tokens[i - 1]
        if token.after or token.text not in ("-", "!"):
            return
        unary = (previous.kind == "sign" and previous.text not in (")", "]", "}")) or \
            previous.text == "return"
        if not unary:
            return
        word = self.left_of_prefix(i)
        name, kind = ("Minus", "sign") if token.text == "-" else ("Not", "logic")
        site = self.add(token, kind, [(token.text + word, word)])
        if site is not None:
            token.insert = f"mutation::{name}{{{site}}}->*"

    def left_of_prefix(self, i):
        words, depth = [], 0
        for token in self.tokens[i + 1:]:
            if token.text in "([":
                depth += 1
            elif token.text in ")]":
                depth -= 1
                if depth < 0:
                    break
            elif depth == 0 and (token.text in ",;?:{}" or (token.before and words)):
                break
            words.append(spelled(token, bool(words)))
        return "".join(words)

    def number(self, i):
        token, previous, following = self.tokens[i], self.tokens[i - 1], self.tokens[i + 1]
        text = token.text
        if self.is_extent(i):
            return
        integer = re.fullmatch(r"\d+", text)
        kind = "constant"
        if integer:
            n = int(text)
            if token.loop and previous.text in ("<", "<="):
                changed = n - 1
            elif token.index or self.is_matrix_index(i):
                kind = "index"
                changed = n - 1 if n else 1
            else:
                changed = n + 1
            replaced = str(changed)
        elif re.fullmatch(r"[\d.]+(?:[eE][+-]?\d+)?", text):
            if float(text) == 0.0:
                replaced = "1.0"
            else:
                replaced = f"1.5 * {text}"
        else:
            return
        head, tail = "", following.text if following.text in (")", "]") else ""
        if kind == "index" and self.is_matrix_index(i) and previous.text in ("(", ","):
            first = previous.text == "(" and following.text == ","
            head = self.tokens[i - 2 if previous.text == "(" else i - 4].text + "("
            head += "" if previous.text == "(" else self.tokens[i - 2].text + ", "
            tail = f", {self.tokens[i + 2].text})" if first else ")"
        elif previous.text in ("(", "["):
            head = self.tokens[i - 2].text + previous.text
        elif previous.text in BINARY:
            head = previous.text + " "
        context = lambda x: f"{head}{x}{tail}"
        site = self.add(token, kind, [(context(text), context(replaced))])
        if site is not None:
            token.insert = f"mutation::constant({site}, {text}, {replaced})"

    def is_extent(self, i):
        """The number of elements in a declaration, `R J[2][2]`."""
        if not self.tokens[i].index or self.tokens[i - 1].text != "[":
            return False
        j = i - 1
        while self.tokens[j].text == "[" and self.tokens[j - 1].text == "]":
            j -= 3
        return self.tokens[j - 1].kind == "name" and (
            self.tokens[j - 2].kind == "name" and self.tokens[j - 2].text != "return" or
            self.tokens[j - 2].text in (">", "&"))

    def is_matrix_index(self, i):
        """`A(0, 1)`, `.col(0)`, `beta(0, 0)`."""
        t = self.tokens
        if t[i - 1].text == "(" and t[i + 1].text == ")":
            return t[i - 2].text in ("col", "row")
        if t[i - 1].text == "(" and t[i + 1].text == "," and t[i + 3].text == ")":
            return t[i - 2].kind == "name" and t[i + 2].kind == "number"
        if t[i - 1].text == "," and t[i + 1].text == ")" and t[i - 3].text == "(":
            return t[i - 4].kind == "name" and t[i - 2].kind == "number"
        return False

    def function(self, i):
        token, following, previous = self.tokens[i], self.tokens[i + 1], self.tokens[i - 1]
        if following.text != "(" or self.name == SCALAR:
            return False
        if token.text in FUNCTIONS and previous.text not in (".", "->", "::"):
            proxy, other = FUNCTIONS[token.text]
        elif token.text in STD_FUNCTIONS and previous.text == "::" and \
                self.tokens[i - 2].text == "std":
            proxy, other = STD_FUNCTIONS[token.text]
        else:
            return False
        if self.tokens[i + 2].text == "{":
            return False
        end = matching(self.tokens, i + 1, "(", ")")
        arguments = "".join(spelled(t, True) for t in self.tokens[i + 1:end + 1])
        site = self.add(token, "function", [(token.text + arguments, other + arguments)])
        if site is not None:
            token.insert = f"mutation::{proxy}{{{site}}}"
            if previous.text == "::":
                previous.insert = self.tokens[i - 2].insert = ""
        return True

    def transpose(self, i):
        t = self.tokens
        if [x.text for x in t[i:i + 4]] != [".", "transpose", "(", ")"]:
            return
        if t[i + 4].text in (".", "(", "[", "->"):
            return
        word = self.left_word(i)
        site = self.add(t[i], "transposition", [(word + ".transpose()", word)])
        if site is not None:
            t[i + 3].insert = f") ->* mutation::Transposed{{{site}}}"

    def increment(self, i):
        token = self.tokens[i]
        if token.text not in ("+=", "-="):
            return
        line = self.right_statement(i)
        other = {"+=": "-=", "-=": "+="}[token.text]
        left = self.left_word(i)
        site = self.add(token, "sign", [(f"{left} {token.text} {line}", f"{left} {other} {line}"),
                                        (f"{left} {token.text} {line}", "")])
        if site is not None:
            self.mutants[-1]["kind"] = "dropped term"
            token.insert = f"{token.text} mutation::Increment{{{site}}} *="

    def right_statement(self, i):
        words = []
        for token in self.tokens[i + 1:]:
            if token.text == ";":
                break
            words.append(spelled(token, bool(words)))
        return "".join(words)

    def chains(self):
        """Twin variables: y1 for y2, .m11 for .m22. A name has to be declared in an earlier
        statement, in the parameters or in the class."""
        scopes, pending, i = [set()], set(), 0
        loops = []  # where the scopes of for loops end that have no braces of their own
        t = self.tokens
        while i < len(t):
            token = t[i]
            while loops and i > loops[-1]:
                loops.pop()
                scopes.pop()
                pending = set()
            if token.text == "for" and t[i + 1].text == "(":
                loops.append(self.statement_end_of_loop(i))
                scopes.append(set())
            if token.text in (";", "{", "}"):
                if token.text == "{":
                    scopes.append(pending)  # parameters, loop variables
                else:
                    scopes[-1] |= pending
                if token.text == "}" and len(scopes) > 1:
                    scopes.pop()
                pending = set()
            elif token.kind == "name":
                end = i
                while end + 2 < len(t) and t[end + 1].text in (".", "->") and \
                        t[end + 2].kind == "name" and t[end + 2].text != "template":
                    end += 2
                if token.live:
                    self.chain(i, end, set().union(*scopes))
                pending.add(token.text)
                i = end
            i += 1

    def statement_end_of_loop(self, i):
        """The last token of the loop that begins at i, or of what stands in a lone statement's place."""
        t = self.tokens
        j = matching(t, i + 1, "(", ")") + 1
        if t[j].text in ("for", "while", "if") and t[j + 1].text == "(":
            return self.statement_end_of_loop(j)
        if t[j].text == "{":
            return matching(t, j, "{", "}")
        depth = 0
        while depth or t[j].text != ";":
            depth += (t[j].text in ("(", "[", "{")) - (t[j].text in (")", "]", "}"))
            j += 1
        return j

    def chain(self, first, last, known):
        t = self.tokens
        following = t[last + 1].text
        if t[first - 1].text in (".", "->", "::", ")", "]") and t[first - 1].text != ")":
            return
        if t[first - 1].kind == "name" and t[first - 1].text != "return":
            return  # a declaration
        if following in ("=", "+=", "-=", "*=", "::", "<"):
            return
        if t[first].insert is not None:
            return
        if following in ("(", "["):
            if last == first or following == "[":
                position = last if following == "[" else None
            else:
                position = None
            candidates = [] if position is None else [position]
            if following == "(" and last > first:
                candidates = list(range(first, last - 1, 2))
                last -= 2
        else:
            candidates = list(range(first, last + 1, 2))
        position = None
        for j in reversed(candidates):
            other = twin_of(t[j].text, j > first)
            if other and (j == first or self.have_both(t[j].text, other)):
                position = j
                break
        if position is None:
            return
        other = twin_of(t[position].text)
        if position == first:
            if {t[position].text, other} in MEMBERS_ONLY:
                return
            if len(other) == 1 and last > first:
                return  # a state `s` is no cosine `c`
            locally = t[position].text in known and other in known
            members = set().union(*t[first].classes[-1:]) - known
            as_member = t[position].text in members and other in members
            if not (locally or as_member):
                return
        words = [x.text for x in t[first:last + 1]]
        changed = list(words)
        changed[position - first] = other
        before, after = "".join(words), "".join(changed)
        site = self.add(t[position], "twin", [(before, after)])
        if site is None:
            return
        for x in t[first:last + 1]:
            x.insert = ""
        t[first].insert = f"mutation::twin({site}, {before}, {after})"

    def have_both(self, name, other):
        """Whether a class that has a member of this name has the other one too: all that have it, or
        all that have it in this header."""
        return any(with_name and all(other in c for c in with_name) for with_name in (
            [c for c in self.members if name in c],
            [c for c in self.members if name in c and c.header == self.name]))

    def run(self):
        for i, token in enumerate(self.tokens):
            if not token.live:
                continue
            if token.kind == "sign":
                self.capture(i)
                self.binary(i)
                self.connective(i)
                self.prefix(i)
                self.transpose(i)
                self.increment(i)
            elif token.kind == "number":
                self.number(i)
            elif token.kind == "name":
                self.function(i)
                self.literal(i)
                if token.text == "constexpr" and self.tokens[i - 1].text != "if":
                    token.insert = "const"
        self.conditions()
        self.statements()
        self.chains()
        return self.text()

    def capture(self, i):
        """Proxies take references: a lambda needs even the constants that it could use without."""
        t = self.tokens
        if t[i].text == "[" and t[i + 1].text == "]" and t[i + 2].text in ("(", "{", "<"):
            t[i].insert = "[="

    def literal(self, i):
        token = self.tokens[i]
        other = {"true": "false", "false": "true"}.get(token.text)
        if other:
            site = self.add(token, "constant", [(token.text, other)])
            if site is not None:
                token.insert = f"mutation::constant({site}, {token.text}, {other})"

    def conditions(self):
        """`if (x)` and `x ? a : b` that no operator decides."""
        t = self.tokens
        for i, token in enumerate(t):
            if token.text in ("if", "while") and t[i + 1].text == "(" and t[i + 2].live:
                first, last = i + 2, matching(t, i + 1, "(", ")") - 1
            elif token.text == "?" and token.live:
                last = first = i - 1
                depth = 0
                while True:
                    text = t[first].text
                    depth += (text in ")]}") - (text in "([{") if text else 0
                    if depth < 0 or depth == 0 and text in ("=", ",", ";", "return", "?", ":", "<<"):
                        break
                    first -= 1
                first += 1
            else:
                continue
            if self.decided(first, last):
                continue
            words = self.words(first, last)
            if token.text == "?":
                site = self.add(token, "condition", [(words + " ?", f"!({words}) ?")])
            else:
                site = self.add(token, "condition",
                                [(f"{token.text} ({words})", f"{token.text} (!({words}))")])
            if site is not None:
                t[last].behind += f" || mutation::Choice{{{site}}}"

    def decided(self, first, last):
        """Whether operators decide, whose own mutants say as much, or it is no plain expression."""
        t, depth = self.tokens, 0
        if t[first].text == "!":
            return True
        for token in t[first:last + 1]:
            depth += (token.text in ("(", "[", "{")) - (token.text in (")", "]", "}"))
            if depth == 0 and (token.text in ("=", ";", "?", ",") or
                               token.text in DECIDES and token.before and token.after):
                return True
        return False

    def words(self, first, last):
        return "".join(spelled(x, k > 0) for k, x in enumerate(self.tokens[first:last + 1]))

    def statements(self):
        """Assignments, calls, jumps and steps of a counter that may be left out."""
        t, open_brackets = self.tokens, []
        for i, token in enumerate(t):
            if token.text in ("(", "[", "{"):
                open_brackets.append(token.text)
            elif token.text in (")", "]", "}"):
                open_brackets.pop()
            if not token.live or not open_brackets or open_brackets[-1] != "{" or not i:
                continue
            before = t[i - 1].text
            begins = before in (";", "{", "}", "else", "do") or before == ")" and self.head_ends(i - 1)
            end = self.statement_end(i) if begins else None
            if end is None:
                continue
            words = self.words(i, end)
            site = self.add(token, "dropped statement", [(words, "")])
            if site is not None:
                token.ahead = f"{{ if (mutation::kept({site})) " + token.ahead
                t[end].behind += " }"

    def head_ends(self, i):
        """Whether the bracket at i closes the head of an if, for or while."""
        depth = 0
        for j in range(i, -1, -1):
            depth += (self.tokens[j].text == ")") - (self.tokens[j].text == "(")
            if depth == 0:
                word = self.tokens[j - 1].text
                return word in ("if", "for", "while") or \
                    word == "constexpr" and self.tokens[j - 2].text == "if"
        return False

    def statement_end(self, i):
        """The semicolon of a statement that begins at i and may be left out; None for others."""
        t = self.tokens
        if t[i].text in ("break", "continue", "return"):
            return i + 1 if t[i + 1].text == ";" else None
        if t[i].text in ("++", "--"):
            end = self.operand_end(i + 1)
            return end if end is not None and t[end].text == ";" else None
        if t[i].text.startswith("require_"):
            return None  # refuses input
        end = self.operand_end(i + 1 if t[i].text == "*" else i)
        if end is None:
            return None
        if t[end].text == ";" and t[end - 1].text == ")":
            return end
        if t[end].text in ("++", "--") and t[end + 1].text == ";":
            return end + 1
        if t[end].text not in ("=", "*=", "/=", "|=", "&=", "%=", "<<=", ">>=", "^="):
            return None
        depth = 0
        for j in range(end, len(t)):
            depth += (t[j].text in ("(", "[", "{")) - (t[j].text in (")", "]", "}"))
            if depth < 0:
                return None
            if depth == 0 and t[j].text == ";":
                return j
        return None

    def operand_end(self, i):
        """Behind `a.b<c>(d)[e]`: what an assignment has on its left, or a call as a whole."""
        t = self.tokens
        if t[i].kind != "name" or t[i].text in KEYWORDS:
            return None
        i += 1
        while True:
            text = t[i].text
            if text in (".", "->", "::"):
                i += 1 + (t[i + 1].text == "template")
                if t[i].kind != "name":
                    return None
                i += 1
            elif text in ("(", "["):
                i = matching(t, i, text, ")" if text == "(" else "]") + 1
            elif text == "<" and template_end(t, i) is not None:
                i = template_end(t, i) + 1
                if t[i].text not in ("(", "::"):
                    return None
            else:
                return i

    def text(self):
        out, tokens = [], iter(self.tokens)
        for kind, text, line in self.raw:
            if kind in ("space", "comment", "directive"):
                out.append(text)
            else:
                token = next(tokens)
                out.append(token.ahead + (token.text if token.insert is None else token.insert) +
                           token.behind)
        body = "".join(out)
        first, rest = body.split("\n", 1)
        # The header that declares the functions cannot have proxies for them.
        functions = "" if self.name == SCALAR else "function_"
        return (f'{first}\n#include "mutation/{functions}proxies.hpp"\n#line 2 "{self.name}"\n{rest}')


def spelled(token, inner):
    return (" " if token.before and inner else "") + token.text


def write_if_changed(path, text):
    path.parent.mkdir(parents=True, exist_ok=True)
    if not path.exists() or path.read_text() != text:
        path.write_text(text)


def covered(include, suite=None):
    """Names of the headers that mutants are made of: {name: path}."""
    folders = SUITES[suite] if suite else sum(SUITES.values(), ())
    found = {}
    for path in sorted(pathlib.Path(include).rglob("*.hpp")):
        name = path.relative_to(include).as_posix()
        parts = name.split("/")
        if len(parts) > 2 and parts[1] in folders and name not in HEADERS_LEFT_ALONE:
            found[name] = path
    return found


def suite_of(name):
    folder = name.split("/")[1]
    return next((suite for suite, folders in SUITES.items() if folder in folders), None)


def members_of(include):
    """The Members of every class of the library."""
    classes = []
    for path in sorted(pathlib.Path(include).rglob("*.hpp")):
        own = []
        mark(tokenize(path.read_text())[1], own)
        for c in own:
            c.header = path.relative_to(include).as_posix()
        classes += own
    return classes


def instrument(include, output, suite, dropped=(), only=None):
    """Returns the mutants. dropped: pairs (file, line) left alone; only: the headers to break."""
    include, output = pathlib.Path(include), pathlib.Path(output)
    mutants, wanted, members = [], set(), members_of(include)
    broken = {n for n in covered(include, suite) if only is None or n in only}
    # Numbers of their own for every header, so that a change to one leaves the others' copies alone.
    first_site = {name: k * SITES_OF_A_HEADER for k, name in enumerate(covered(include, suite))}
    for header in sorted(include.rglob("*.hpp")):
        name = header.relative_to(include).as_posix()
        wanted.add(output / "include" / name)
        text = header.read_text()
        if name in broken:
            lines = {line for file, line in dropped if file == name}
            work = Instrumenter(name, text, first_site[name], lines, members)
            text = work.run()
            mutants += work.mutants
            if work.site - first_site[name] >= SITES_OF_A_HEADER:
                raise ValueError(f"{name} has more than {SITES_OF_A_HEADER} sites")
        for long, short in SHORTER.items():
            text = text.replace(long, short)
        write_if_changed(output / "include" / name, text)
    for stale in set((output / "include").rglob("*.hpp")) - wanted:
        stale.unlink()
    seen = collections.Counter()
    for number, mutant in enumerate(mutants, 1):
        mutant["id"] = number
        # A name that outlives line numbers; the second of its kind on equal lines has a #2.
        name = (mutant["file"], mutant["text"], mutant["before"], mutant["after"])
        seen[name] += 1
        mutant["change"] = f"{mutant['before']} => {mutant['after']}" + (
            f" #{seen[name]}" if seen[name] > 1 else "")
    write_if_changed(output / "mutants.json", json.dumps(mutants, indent=1) + "\n")
    return mutants


def lines_of(path):
    return path.read_text().split() if path.exists() else None


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("include")
    parser.add_argument("output", type=pathlib.Path)
    parser.add_argument("suite", choices=SUITES)
    arguments = parser.parse_args()
    dropped = {(file, int(number)) for file, number in
               (line.rsplit(":", 1) for line in lines_of(arguments.output / "dropped.txt") or ())}
    only = lines_of(arguments.output / "only.txt")
    mutants = instrument(arguments.include, arguments.output, arguments.suite, dropped, only)
    print(f"{len(mutants)} mutants at {len({m['site'] for m in mutants})} sites")


if __name__ == "__main__":
    main()
