#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Ties proofs to kernels: derives the expressions that a kernel evaluates from the code that clang makes of its text.

A proof NAME.v (Coq) or NAME.g (Gappa) has a probe NAME.cl beside it: a kernel that calls the functions of kernels/ with
inputs of its own and stores the results. clang compiles the probe; its floats' operations, executed here on symbols, are
the expressions, in their order, with the kernel's constants. They stand in the proof between two lines,

    begin: from the kernels, by expressions.py        ...        end: from the kernels

so that what is proved is what runs. The operands of + and * are ordered by name, as their order changes no bit.
A quotient or a maximum becomes an input of what uses it, quotient_1 or greater_1, after definitions of its two operands.
A sign that is taken from a float's bits and given to others by their bits is left out: it turns values, not their errors.

usage: expressions.py FILE...           fails if a proof's part is not what the kernels evaluate
       expressions.py --write FILE...   writes that part
GNOMON_KERNELS_DIR names another folder of kernels, as for the programs.
"""
import difflib
import functools
import os
import re
import shutil
import struct
import subprocess
import sys
import textwrap
from fractions import Fraction
from pathlib import Path

HERE = Path(__file__).resolve().parent
KERNELS = Path(os.environ.get("GNOMON_KERNELS_DIR", HERE.parent.parent / "kernels"))
BEGIN, END = "begin: from the kernels, by expressions.py", "end: from the kernels"


def fail(message):
    sys.exit(f"expressions.py: {message}")


# ---- Expressions: tuples of an operation and its operands; equal expressions are equal tuples. -------------------------

COMMUTATIVE = ("add", "mul", "max", "min", "and", "or")


def node(operation, *operands):
    if operation in COMMUTATIVE or operation == "fma":
        operands = tuple(sorted(operands[:2], key=repr)) + operands[2:]
    if operation in ("max", "min") and operands[0] == operands[1]:
        return operands[0]
    if operation in ("neg", "abs") and operands[0][0] == "const":
        value = operands[0][1]
        return ("const", -value if operation == "neg" else abs(value))
    return (operation, *operands)


def as_minimum(condition, yes, no):
    """The minimum or maximum that a comparison and a selection make (LANES_MIN); None if they make none."""
    if condition[0] in ("olt", "ole", "ogt", "oge") and {condition[1], condition[2]} == {yes, no}:
        is_less = (condition[0] in ("olt", "ole")) == (condition[1] == yes)
        return node("min" if is_less else "max", yes, no)
    return None


def negated(condition):
    turned = {"ugt": "ole", "uge": "olt", "ult": "oge", "ule": "ogt", "and": "or", "or": "and"}
    operands = [negated(o) for o in condition[1:]] if condition[0] in ("and", "or") else condition[1:]
    if condition[0] not in turned:
        return operands[0] if condition[0] == "not" else ("not", condition)
    return node(turned[condition[0]], *operands)


def selection(condition, yes, no):
    if no == ("false",):
        return node("and", condition, yes)
    if yes == ("true",):
        return node("or", condition, no)
    if yes == no:
        return yes
    if yes == ("infinity",):
        return selection(negated(condition), no, yes)
    if yes == ("const", 0) and not as_minimum(condition, yes, no):
        return node("select", negated(condition), no, yes)
    return as_minimum(condition, yes, no) or node("select", condition, yes, no)


# ---- LLVM's text -----------------------------------------------------------------------------------------------------

OPERATIONS = {"fadd": "add", "fsub": "sub", "fmul": "mul", "fdiv": "div"}
BUILTINS = {"fabs": "abs", "fma": "fma", "fmax": "max", "fmin": "min", "max": "max", "min": "min", "sqrt": "sqrt",
            "floor": "floor"}
TYPE = r"(?:<\d+ x [\w.]+>(?: addrspace\(\d+\)\*)?|\[[^\]]*\]|%?[\w.]+(?: addrspace\(\d+\))?\*?)"


def split_operands(text):
    """Splits at the commas that are in no brackets."""
    parts, depth, start = [], 0, 0
    for i, c in enumerate(text):
        depth += c in "<([{"
        depth -= c in ">)]}"
        if c == "," and depth == 0:
            parts.append(text[start:i].strip())
            start = i + 1
    return parts + [text[start:].strip()]


def constant(text):
    if text in ("true", "false"):
        return (text,)
    if text in ("undef", "poison"):
        return ("undef",)
    if text.startswith("0x"):
        value = struct.unpack(">d", bytes.fromhex(text[2:].rjust(16, "0")))[0]
        return ("infinity",) if value in (float("inf"),) else ("const", Fraction(value)) if value == value else ("nan",)
    if re.fullmatch(r"-?\d+", text):
        return ("const", Fraction(int(text)))
    return ("const", Fraction(float(text)))


class Probe:
    """Executes one kernel, without branches, on symbols."""

    def __init__(self, llvm):
        match = re.search(r"define [^@]*@(probe)\((.*)\) [^()\n]*\{\n((?:[^}].*\n|\n)*)\}", llvm)
        if not match:
            fail("the probe has no kernel")
        self.values, self.outputs, self.inputs, self.copies = {}, {}, [], {}
        for parameter in split_operands(match.group(2)):
            kind, name = re.match(rf"({TYPE})", parameter).group(1), parameter.split("%")[-1]
            if kind.endswith("*"):
                self.values["%" + name] = ("pointer", name, ())
            else:
                count = re.match(r"<(\d+) x", kind)
                names = [f"{name}_{c}" for c in "xyzw"[: int(count.group(1))]] if count else [name]
                self.inputs += names
                self.values["%" + name] = [("in", n) for n in names] if count else ("in", names[0])
        for line in match.group(3).splitlines():
            line = re.sub(r", !(?:tbaa|fpmath).*|, align \d+.*", "", line.split(" #")[0].strip())
            if line and not line.endswith(":") and line != "ret void":
                self.execute(line)

    def value(self, text):
        text = text.strip()
        if text.startswith("%"):
            return self.values[text]
        if text.startswith("<"):
            return [constant(part.split()[-1]) for part in split_operands(text[1:-1])]
        return constant(text)

    def typed(self, text):
        """The value of `type [attributes] value`."""
        kind = re.match(rf"{TYPE}", text).group(0)
        value = re.sub(r"^(?:(?:noundef|nonnull|inbounds|nocapture) )*", "", text[len(kind):].strip())
        if value in ("undef", "poison", "zeroinitializer"):
            count = re.match(r"<(\d+) x", kind)
            one = ("const", Fraction(0)) if value == "zeroinitializer" else ("undef",)
            return [one] * int(count.group(1)) if count else one
        return self.value(value)

    def each(self, operation, *operands):
        if isinstance(operands[0], list):
            return [node(operation, *of) for of in zip(*operands)]
        return node(operation, *operands)

    def input(self, name):
        first, _, path = name.partition("_")
        name = "_".join([self.copies[first], path]) if first in self.copies else name
        if name not in self.inputs:
            self.inputs.append(name)
        return ("in", name)

    def execute(self, line):
        if "@llvm.lifetime" in line or "@llvm.assume" in line:
            return
        if "@llvm.memcpy" in line:  # a local copy of an input
            to, of = (self.value(o.split()[-1]) for o in split_operands(line[line.index("(") + 1:-1])[:2])
            self.copies[to[1]] = of[1]
            return
        if line.startswith("store "):
            what, where = split_operands(line[len("store "):])
            pointer = self.typed(where)
            self.outputs[pointer[1] + "".join(f"_{i}" for i in pointer[2])] = self.typed(what)
            return
        target, text = line.split(" = ", 1)
        name = text.split()[0]
        rest = text[len(name):].strip()
        if name in ("tail", "notail"):
            name, rest = "call", rest[len("call"):].strip()
        self.values[target] = self.result(name, rest, line)

    def result(self, name, rest, line):
        if name == "and" and rest.startswith("i32 ") and rest.endswith(", -2147483648"):
            return ("sign",)
        if name == "xor" and rest.startswith("i32 "):
            a, b = (self.value(o) for o in split_operands(rest[len("i32 "):]))
            if ("sign",) in (a, b):
                return b if a == ("sign",) else a
        if name in OPERATIONS:
            kind = re.match(rf"{TYPE} ", rest).group(0)
            a, b = split_operands(rest)
            return self.each(OPERATIONS[name], self.typed(a), self.typed(kind + b))
        if name == "fneg":
            return self.each("neg", self.typed(rest))
        if name == "icmp":  # a probe may assume it; no expression has it
            return ("icmp",)
        if name == "fcmp":
            kind, rest = rest.split(" ", 1)
            first, second = split_operands(rest)
            of = re.match(rf"{TYPE} ", first).group(0)
            return self.each(kind, self.typed(first), self.typed(of + second))
        if name == "select":
            condition, yes, no = (self.typed(part) for part in split_operands(rest))
            if isinstance(condition, list):
                return [selection(*of) for of in zip(condition, yes, no)]
            return selection(condition, yes, no)
        if name in ("and", "or") and re.match(r"(<\d+ x )?i1", rest):
            kind = re.match(rf"{TYPE} ", rest).group(0)
            a, b = split_operands(rest)
            return self.each(name, self.typed(a), self.typed(kind + b))
        if name == "xor" and rest.startswith("i1 ") and rest.endswith(", true"):
            return negated(self.typed(rest.rsplit(",", 1)[0]))
        if name == "alloca":
            return ("pointer", line.split(" = ")[0].strip("%"), ())
        if name == "call":
            called, operands = re.search(r"@(\w[\w.]*)\((.*)\)", rest).groups()
            mangled = re.match(r"_Z(\d+)(\w+)", called)
            builtin = mangled.group(2)[: int(mangled.group(1))] if mangled else called.removeprefix("llvm.").split(".")[0]
            if builtin == "vload3":
                _, name, path = self.typed(split_operands(operands)[1])
                return [self.input("_".join(map(str, (name, *path[:-1], path[-1] + i)))) for i in range(3)]
            if builtin == "select":
                no, yes, condition = (self.typed(o) for o in split_operands(operands))
                return [selection(*of) for of in zip(condition, yes, no)]
            if builtin == "dot":  # any order of its sums has as few roundings
                a, b = (self.typed(o) for o in split_operands(operands))
                products = [node("mul", *of) for of in zip(a, b)]
                return functools.reduce(lambda sum_so_far, one: node("add", sum_so_far, one), products)
            if builtin not in BUILTINS:
                fail(f"unknown function: {line}")
            return self.each(BUILTINS[builtin], *(self.typed(o) for o in split_operands(operands)))
        if name == "extractelement":
            vector, index = split_operands(rest)
            return self.typed(vector)[int(index.split()[-1])]
        if name == "insertelement":
            vector, one, index = split_operands(rest)
            made = list(self.typed(vector))
            made[int(index.split()[-1])] = self.typed(one)
            return made
        if name == "shufflevector":
            a, b, mask = split_operands(rest)
            both = self.typed(a) + self.typed(b)
            if mask.endswith("zeroinitializer"):
                return [both[0]] * int(re.match(r"<(\d+)", mask).group(1))
            picks = re.findall(r"i32 (\w+)", mask.split(">", 1)[1])
            return [both[int(i)] if i.isdigit() else ("undef",) for i in picks]
        if name in ("fpext", "uitofp", "sitofp", "bitcast", "sext"):  # exact (of integers: below 2^24)
            return self.typed(rest.rsplit(" to ", 1)[0])
        if name == "getelementptr":
            parts = split_operands(rest)
            base = self.typed(parts[1])
            steps = tuple(int(p.split()[-1]) for p in parts[2:])
            return ("pointer", base[1], base[2] + (steps[1:] if steps[0] == 0 else steps))
        if name == "load":
            kind, pointer = (split_operands(rest)[0], self.typed(split_operands(rest)[1]))
            count = re.match(r"<(\d+) x", kind)
            if count:  # neighbours in memory
                return [self.input("_".join(map(str, (pointer[1], *pointer[2][:-1], pointer[2][-1] + i))))
                        for i in range(int(count.group(1)))]
            return self.input(pointer[1] + "".join(f"_{i}" for i in pointer[2]))
        return fail(f"unknown instruction: {line}")


def derive(probe):
    """The inputs and outputs of a probe, by name."""
    clang = shutil.which("clang-14")  # one version: another may print the same expressions in other words
    if not clang:
        print("NOT TESTED: there is no clang-14 here")
        sys.exit(77)
    lanes = 16 if "\n// 16 lanes\n" in probe.read_text() else 1
    made = subprocess.run(
        [clang, "-x", "cl", "-cl-std=CL1.2", "-Xclang", "-finclude-default-header", "-target", "spir64-unknown-unknown",
         "-fno-discard-value-names", "-fno-vectorize", "-fno-slp-vectorize", f"-DGN_LANES={lanes}",
         f"-I{KERNELS}", "-O2", "-mllvm", "-inline-threshold=100000", "-S", "-emit-llvm", "-w", "-o", "-", str(probe)], capture_output=True, text=True)
    if made.returncode != 0:
        fail(f"clang refuses {probe}:\n{made.stderr}")
    found = Probe(made.stdout)
    outputs = {}
    for name, value in found.outputs.items():
        if isinstance(value, list):
            outputs.update({f"{name}_{c}": v for c, v in zip("xyzw", value)})
        else:
            outputs[name] = value
    return found.inputs, outputs


# ---- Text for the provers --------------------------------------------------------------------------------------------

def rational(value):
    return f"{value.numerator} # {value.denominator}"


def coq_term(e, defined):
    if e in defined:
        return defined[e]
    name, operands = e[0], e[1:]
    if name == "sub" and all(defined.get(o, "").endswith(" 0)") for o in operands):
        return f"(Diff {operands[0][1]} {operands[1][1]})"
    if name == "const":
        return f"(Const ({rational(operands[0])}))"
    if name == "mul" and "const" in (operands[0][0], operands[1][0]):
        factor, of = operands if operands[0][0] == "const" else reversed(operands)
        return f"(Times ({rational(factor[1])}) {coq_term(of, defined)})"
    constructors = {"add": "Add", "sub": "Sub", "mul": "Mul", "fma": "Fma", "neg": "Neg", "abs": "Abs"}
    if name not in constructors:
        fail(f"no such operation in Roundings.v: {name}")
    return f"({constructors[name]} {' '.join(coq_term(o, defined) for o in operands)})"


CUTS = {"div": ("quotient", "over", "under"), "max": ("greater", "one", "other"), "min": ("lesser", "one", "other")}


def cut(outputs):
    """The inputs in place of quotients and maxima; the outputs with them, whose operands become outputs before; and the
    conditions under which values are neither 0 nor infinite."""
    made, inputs, limits = {}, {}, []

    def operands_of(e, by):
        return (e[0], *(by(o) if isinstance(o, tuple) else o for o in e[1:]))

    def is_limited(e):
        return e[0] == "select" and e[3] in (("const", 0), ("infinity",))

    def known(e):
        e = known(e[2]) if is_limited(e) else operands_of(e, known)
        return ("in", inputs[e]) if e in inputs else e

    def replaced(e):
        if is_limited(e):
            limits.append(e[1])
            return replaced(e[2])
        e = operands_of(e, replaced)
        if e[0] in CUTS and e not in inputs:
            kind, first, second = CUTS[e[0]]
            inputs[e] = f"{kind}_{sum(name.startswith(kind) for name in inputs.values()) + 1}"
            made[f"{inputs[e]}_{first}"], made[f"{inputs[e]}_{second}"] = e[1:]
        return ("in", inputs[e]) if e in inputs else e

    for name, e in outputs.items():
        is_bound = e[0] == "select" and e[3] == ("infinity",)
        made[name] = (*e[:2], replaced(e[2]), e[3]) if is_bound else replaced(e)
    made = {name: (*e[:1], known(e[1]), *e[2:]) if e[0] == "select" else e for name, e in made.items()}
    limits = [known(c) for limit in limits for c in conditions(limit)]
    return list(inputs.values()), made, [c for i, c in enumerate(limits) if c not in limits[:i]]


def used_inputs(e):
    return {e[1]} if e[0] == "in" else set().union(*(used_inputs(o) for o in e[1:] if isinstance(o, tuple)), set())


def conditions(e):
    """The comparisons with constants that a condition is made of."""
    if e[0] == "and":
        return conditions(e[1]) + conditions(e[2])
    return [e]


def plain(e):
    """For people: an expression as text."""
    if e[0] == "in":
        return e[1]
    if e[0] == "const":
        return str(float(e[1]))
    return f"{e[0]}({', '.join(plain(o) for o in e[1:])})" if len(e) > 1 else e[0]


def coq_block(inputs, outputs, limits, met):
    """The inputs' numbers, and one definition for each output: an expression, or a constant times another output."""
    used = set().union(*(used_inputs(e) for e in outputs.values()))
    lines = [f"Definition {name} := {number}%nat." for number, name in enumerate(n for n in inputs if n in used)]
    defined = {("in", name): f"(Given {name} {met(name)})" for name in used}
    for name, e in outputs.items():
        lines += coq_output(name, e, defined)
    for c in limits:
        lines += wrapped(f"(* where {plain_condition(c, defined)} *)")
    return lines


def coq_output(name, e, defined):
    if e[0] == "in":
        return [f"Definition {name} := Given {e[1]} {re.search('[0-9]+', defined[e].split()[-1]).group(0)}."]
    if e[0] == "select" and e[3] == ("infinity",):  # a bound, where the level may be used
        limits = [f"(* {name}: where {plain_condition(c, defined)} *)" for c in conditions(e[1])]
        return [part for limit in sorted(limits) for part in wrapped(limit)] + coq_output(name, e[2], defined)
    if e[0] == "mul" and "const" in (e[1][0], e[2][0]):
        factor, of = (e[1], e[2]) if e[1][0] == "const" else (e[2], e[1])
        if of in defined:
            return [f"(* {name} = {name}_constant * {defined[of]} *)",
                    f"Definition {name}_constant : Q := {rational(factor[1])}."]
    if e[0] == "add" and "const" in (e[1][0], e[2][0]):  # and a constant
        rest, product = (e[1], e[2]) if e[1][0] == "const" else (e[2], e[1])
        if product[0] == "mul" and any(o in defined for o in product[1:]):
            return coq_output(name, product, defined) + [f"Definition {name}_rest : Q := {rational(rest[1])}."]
    term = coq_term(e, defined)
    defined[e] = name
    return [f"Definition {name} :="] + wrapped("  " + term.strip("(").rstrip(")") + ")" * (len(term) - len(
        term.rstrip(")")) - 1) + ".", "    ")


def wrapped(text, indent="   "):
    return textwrap.wrap(text, 116, subsequent_indent=indent, break_on_hyphens=False)


def plain_condition(c, defined):
    def text(e):
        if e[0] in ("in", "const") or e not in defined:
            return plain(e) if len(e) == 1 or e[0] in ("in", "const") else f"{e[0]}({', '.join(text(o) for o in e[1:])})"
        return defined[e]
    symbols = {"ole": "<=", "oge": ">=", "olt": "<", "ogt": ">"}
    return f"{text(c[1])} {symbols.get(c[0], c[0])} {text(c[2])}"


def gappa_block(inputs, outputs):
    """Each operation on a line of its own; the format is `rnd`."""
    lines, defined = [], {}
    symbols = {"add": "{} + {}", "sub": "{} - {}", "mul": "{} * {}", "div": "{} / {}", "neg": "-{}", "fma": "{} * {} + {}",
               "abs": "|{}|"}

    def name_of(e, wanted=None):
        if e[0] == "in":
            return e[1]
        if e[0] == "const":
            return f"{e[1].numerator}" if e[1].denominator == 1 else \
                f"{e[1].numerator}b-{e[1].denominator.bit_length() - 1}"
        if e not in defined:
            if e[0] not in symbols:
                fail(f"no such operation for Gappa: {e[0]}")
            operands = [name_of(o) for o in e[1:]]
            defined[e] = wanted or f"t{len(defined)}"
            exact = e[0] in ("neg", "abs")
            lines.append(f"{defined[e]} {'=' if exact else 'rnd='} {symbols[e[0]].format(*operands)};")
        return defined[e]

    for name, e in outputs.items():
        if name_of(e, name) != name:
            lines.append(f"{name} = {name_of(e)};")
    return lines


def roundings_met(probe):
    """Of an input, by the probe's lines `// met before: PREFIX N`: the roundings that it has met before."""
    said = re.findall(r"^// met before: (\w+) (\d+)$", probe.read_text(), re.M)
    return lambda name: next((n for prefix, n in said if name.startswith(prefix)), "0")


def checked(path, write):
    """True if the proof's part is what the kernels evaluate, or has just been written."""
    text = path.read_text()
    lines = text.splitlines()
    begin, end = (next((i for i, l in enumerate(lines) if mark in l), None) for mark in (BEGIN, END))
    if begin is None or end is None:
        fail(f"{path} has no part from the kernels")
    probe = path.with_suffix(".cl")
    inputs, outputs = derive(probe)
    if path.suffix == ".v":
        made, outputs, limits = cut(outputs)
        block = coq_block(inputs + made, outputs, limits, roundings_met(probe))
    else:
        block = gappa_block(inputs, outputs)
    made = lines[: begin + 1] + block + lines[end:]
    if write:
        path.write_text("\n".join(made) + "\n")
    elif made != lines:
        print(f"{path.name} does not prove what the kernels in {KERNELS} evaluate:")
        print("\n".join(difflib.unified_diff(lines, made, "the proof", "the kernels", lineterm="")))
        return False
    return True


if __name__ == "__main__":
    write = sys.argv[1:2] == ["--write"]
    results = [checked(Path(p), write) for p in sys.argv[2 if write else 1:]]
    sys.exit(0 if results and all(results) else 1)
