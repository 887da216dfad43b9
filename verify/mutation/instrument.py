"""Mutant schemata: writes a copy of the headers in which every operator, factor, index and so on of
the kernels can be switched to a wrong one at run time (proxies.hpp, README.md).

    instrument.py <include folder> <output folder> [--only <file>] [--drop <file with path:line>]

The copy has the same lines. The list of mutants goes to <output folder>/mutants.json.
"""

import argparse
import collections
import json
import pathlib
import re

ALWAYS_INLINE = "#define CROSSBEAM_INLINE [[gnu::always_inline]] inline"
KERNELS = ("kinematics", "cell", "law", "element")

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
    "&&": ("And", ["||", None]),
    "||": ("Or", ["&&", None]),
}
LOOP = {
    "<": ("LoopLess", ["+ 1 <", "no turn: <"]),
    "<=": ("LoopLessEqual", ["<", "no turn: <="]),
    ">=": ("LoopGreaterEqual", [">", "no turn: >="]),
}
ARITHMETIC = {"+", "-", "*", "/"}
PRECEDENCE = {"*": 6, "/": 6, "+": 5, "-": 5, "<": 4, "<=": 4, ">": 4, ">=": 4, "==": 3, "!=": 3,
              "&&": 2, "||": 1}
KIND = {"+": "sign", "-": "sign", "*": "factor", "/": "factor", "<": "comparison",
        "<=": "comparison", ">": "comparison", ">=": "comparison", "==": "comparison",
        "!=": "comparison", "&&": "logic", "||": "logic"}

FUNCTIONS = {
    "maximum": ("Maximum", "minimum"), "minimum": ("Minimum", "maximum"),
    "select": ("Select", "select_other"), "cos": ("Cos", "sin"), "sin": ("Sin", "cos"),
    "sqrt": ("Sqrt", ""), "cbrt": ("Cbrt", ""), "magnitude": ("Magnitude", ""),
    "cross": ("Cross", "cross_back"), "all": ("All", "any"), "any": ("Any", "all"),
}
STD_FUNCTIONS = {"max": ("StdMax", "min"), "abs": ("Abs", ""), "hypot": ("Hypot", "")}

TWINS = {}
for pair in ("c s", "c0 s0", "warp weft", "L H", "Lc h", "ka kb", "along across", "ahead behind",
             "hh Lh", "LL hh", "cosine sine", "a_ b_", "xi eta", "sx sy"):
    one, other = pair.split()
    TWINS.setdefault(one, other)
    TWINS.setdefault(other, one)
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


class Token:
    __slots__ = ("kind", "text", "line", "before", "after", "live", "index", "loop", "insert",
                 "classes")

    def __init__(self, kind, text, line):
        self.kind, self.text, self.line = kind, text, line
        self.before = self.after = False  # white space beside it
        self.live = False   # may be mutated
        self.index = False  # inside square brackets
        self.loop = False   # in the condition of a for loop
        self.insert = None  # instrumented text
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


def mark(tokens):
    """Sets `live` in the bodies of functions and in the initialisers of constructors, outside what
    is decided at compile time and outside refusals of input."""
    stack, header, i, classes = [], [], 0, []
    while i < len(tokens):
        token = tokens[i]
        token.classes = tuple(classes)
        function = bool(stack) and stack[-1] in ("function", "block")
        if token.text == "{":
            texts = [t.text for t in header]
            if function:
                stack.append("block")
            elif "requires" in texts and is_requires_expression(header):
                i = matching(tokens, i, "{", "}") + 1
                continue
            elif {"namespace", "struct", "class", "enum", "union"} & set(without_templates(texts)):
                stack.append("scope")
                classes.append(set())
            elif "(" in texts and "concept" not in texts:
                if "constexpr" in texts:
                    stack.append("constexpr")
                else:
                    stack.append("function")
                    mark_initialisers(header)
            else:
                i = matching(tokens, i, "{", "}") + 1  # the initialiser of a member
                continue
            header = []
        elif token.text == "}":
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


class Instrumenter:
    def __init__(self, name, source, first_site, dropped):
        self.name, self.source = name, source
        self.lines = source.split("\n")
        self.site = first_site
        self.dropped = dropped
        self.mutants = []
        self.raw, self.tokens = tokenize(source)
        mark(self.tokens)

    def add(self, token, kind, variants):
        """variants: (before, after) each. Returns the number of the site, or None on a line that
        does not compile with mutants."""
        if token.line in self.dropped:
            return None
        self.site += 1
        for k, (before, after) in enumerate(variants, 1):
            self.mutants.append({"site": self.site, "variant": k, "file": self.name,
                                 "line": token.line, "kind": kind, "before": before,
                                 "after": after,
                                 "text": self.lines[token.line - 1].strip()})
        return self.site

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
                if token.before and token.after and PRECEDENCE.get(token.text, 9) <= own:
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
        if token.text in ("&&", "||") and self.guards_pointer(i):
            return
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
                if token.text in ("&&", "||"):
                    mutant["kind"] = "dropped condition"
        if token.index and token.text in ("+", "-"):
            first = self.mutants.pop(-2)
            self.mutants[-1]["variant"] = 2
            del first
        token.insert = f"{token.text} mutation::{proxy}{{{site}}} {token.text}"

    def guards_pointer(self, i):
        """Short circuits protect the dereference of a pointer; a proxy has none."""
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
        if following.text != "(":
            return False
        if token.text in FUNCTIONS and previous.text not in (".", "->", "::"):
            proxy, other = FUNCTIONS[token.text]
        elif token.text in STD_FUNCTIONS and previous.text == "::" and \
                self.tokens[i - 2].text == "std":
            proxy, other = STD_FUNCTIONS[token.text]
        else:
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
        t = self.tokens
        while i < len(t):
            token = t[i]
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
            if twin_of(t[j].text, j > first):
                position = j
                break
        if position is None:
            return
        other = twin_of(t[position].text)
        if position == first:
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

    def run(self):
        for i, token in enumerate(self.tokens):
            if not token.live:
                continue
            if token.kind == "sign":
                self.binary(i)
                self.prefix(i)
                self.transpose(i)
                self.increment(i)
            elif token.kind == "number":
                self.number(i)
            elif token.kind == "name":
                self.function(i)
                if token.text == "constexpr" and self.tokens[i - 1].text != "if":
                    token.insert = "const"
        self.chains()
        return self.text()

    def text(self):
        out, tokens = [], iter(self.tokens)
        for kind, text, line in self.raw:
            if kind in ("space", "comment", "directive"):
                out.append(text)
            else:
                token = next(tokens)
                out.append(token.text if token.insert is None else token.insert)
        body = "".join(out)
        first, rest = body.split("\n", 1)
        return (f'{first}\n#include "mutation/proxies.hpp"\n#line 2 "{self.name}"\n{rest}')


def spelled(token, inner):
    return (" " if token.before and inner else "") + token.text


def write_if_changed(path, text):
    path.parent.mkdir(parents=True, exist_ok=True)
    if not path.exists() or path.read_text() != text:
        path.write_text(text)


def instrument(include, output, dropped=(), kernels=KERNELS):
    """Returns the mutants. dropped: pairs (file, line) left alone."""
    include, output = pathlib.Path(include), pathlib.Path(output)
    mutants, site, wanted = [], 0, set()
    for header in sorted(include.rglob("*.hpp")):
        name = header.relative_to(include).as_posix()
        wanted.add(output / "include" / name)
        text = header.read_text()
        if len(name.split("/")) > 2 and name.split("/")[1] in kernels:
            lines = {line for file, line in dropped if file == name}
            work = Instrumenter(name, text, site, lines)
            text = work.run()
            mutants += work.mutants
            site = work.site
        # Compiled once instead of at every call: the compiler is what this run waits for.
        text = text.replace(ALWAYS_INLINE, "#define CROSSBEAM_INLINE inline")
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


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("include")
    parser.add_argument("output")
    parser.add_argument("--drop", help="file with lines <header>:<line> to leave alone")
    arguments = parser.parse_args()
    dropped = set()
    if arguments.drop and pathlib.Path(arguments.drop).exists():
        for line in pathlib.Path(arguments.drop).read_text().split():
            file, number = line.rsplit(":", 1)
            dropped.add((file, int(number)))
    mutants = instrument(arguments.include, arguments.output, dropped)
    print(f"{len(mutants)} mutants at {len({m['site'] for m in mutants})} sites")


if __name__ == "__main__":
    main()
