#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Checks the proofs with Coq and Gappa, and prints for each the least constant that it yields beside the kernel's.

usage: check.py coq FOLDER | gappa      FOLDER: for Coq's files. Exit status 77: there is no such prover here.
What Coq said is kept in FOLDER under a digest of the proof, the lemmas and Coq's version, and read again while it is so.
A proof may load a text that another loads too (NAME_body.v). What the proofs assume (their lines `Print Assumptions
NAME.`) is asked of all of them at once: each time Coq walks through all of the reals, 1.5 s of 2.3 to 20.

Fails where a prover does not accept a proof; where the kernel's constant is below the least or more than twice as large,
unless the proof says `loose: WHY` (of one constant `loose others: WHY`); where a proof assumes more than the axioms of
the reals.
"""
import concurrent.futures
import functools
import hashlib
import re
import shutil
import subprocess
import sys
from fractions import Fraction
from pathlib import Path

HERE = Path(__file__).resolve().parent
LEMMAS = ["Roundings", "Devices", "Filters"]
AXIOMS = {"ClassicalDedekindReals.sig_not_dec", "ClassicalDedekindReals.sig_forall_dec",
          "FunctionalExtensionality.functional_extensionality_dep", "Classical_Prop.classic"}
AT_MOST_TIMES = 2
ASSUMPTIONS = re.compile(r"^Print Assumptions (\w+)\.$", re.M)


def coqc(name, folder):
    """The messages of a proof in a copy in `folder`; None if Coq refuses it."""
    made = subprocess.run(["coqc", "-q", f"{name}.v"], cwd=folder, capture_output=True, text=True)
    if made.returncode != 0:
        print(f"{name}: Coq refuses it\n{made.stdout}{made.stderr}")
        return None
    return made.stdout


@functools.cache
def version_of_coq():
    return subprocess.run(["coqc", "--version"], capture_output=True, text=True, check=True).stdout


def text_of(name):
    """The text of a proof with those that it loads."""
    text = (HERE / f"{name}.v").read_text()
    return "\0".join([text, *map(text_of, re.findall(r"^Load (\w+)\.", text, re.M))])


def digest(*names):
    """Of all that Coq's messages about proofs depend on."""
    texts = [text_of(of) for of in [*LEMMAS, *names]]
    return hashlib.sha256("\0".join([version_of_coq(), *texts]).encode()).hexdigest()


def said(kept, folder, names, say):
    """What Coq said of `names`, if they have not changed since, or says now; None if it refuses them."""
    file, of_now = folder / f"{kept}.said", digest(*names)
    if file.exists():
        of, _, messages = file.read_text().partition("\n")
        if of == of_now:
            return messages
    messages = say()
    if messages is not None:
        file.write_text(f"{of_now}\n{messages}")
    return messages


def is_new(name, folder):
    file = folder / f"{name}.said"
    return not file.exists() or file.read_text().partition("\n")[0] != digest(name)


def is_tight(name, what, least, kernel, text):
    ratio = kernel / least
    loose = re.search(rf"loose(?: {what}s)?: ([^\n]*)", text)
    print(f"{name:16} {what:10} least {float(least):.5g}, kernel's {float(kernel):.5g}: {float(ratio):.4g} times"
          + (f" ({loose.group(1).rstrip(' *)')})" if loose and ratio > AT_MOST_TIMES else ""))
    return ratio >= 1 and (ratio <= AT_MOST_TIMES or loose is not None)


def check_coq(name, folder):
    messages = said(name, folder, [name], lambda: coqc(name, folder))
    if messages is None:
        return False
    text = text_of(name)
    good = len(ASSUMPTIONS.findall(text)) == 1
    if not good:
        print(f"{name} does not print what it assumes")
    found = re.findall(r"(constants|rests|others) =\s+\((\d+)%Z,\s+(\d+)%Z,\s+(\d+)%Z,\s+(\d+)%Z\)", messages)
    if not found:
        print(f"{name} names no constants")
    for what, *numbers in found:
        a, b, c, d = map(int, numbers)
        good &= is_tight(name, what[:-1], Fraction(a, b), Fraction(c, d), text)
    return good and bool(found)


def assumed_by_all(names, folder):
    """What Coq says of the assumptions of all proofs; None if it refuses the question."""
    what = [f"{name}.{of}" for name in names for of in ASSUMPTIONS.findall(text_of(name))]
    (folder / "assumed.v").write_text("\n".join([
        "From Coq Require Import Reals QArith.", f"Require {' '.join(names)}.",
        f"Definition all := ({', '.join(what)}).", "Print Assumptions all."]))
    return coqc("assumed", folder)


def check_assumptions(names, folder):
    messages = said("assumed", folder, names, lambda: assumed_by_all(names, folder))
    if messages is None:
        return False
    assumed = set(re.findall(r"^(\w[\w.]*) ?(?::|$)", messages.split("Axioms:", 1)[-1], re.M))
    if assumed <= AXIOMS and "Axioms:" in messages:
        return True
    print(f"the proofs assume {sorted(assumed - AXIOMS)}; the line `Print Assumptions` of each, by hand, says which")
    return False


def lemmas_by_coq(folder):
    for kept in folder.glob("*.said"):  # of proofs that were compiled with other files of the lemmas
        kept.unlink()
    return None if any(coqc(name, folder) is None for name in LEMMAS) else ""


def run_coq(folder):
    if not shutil.which("coqc"):
        print("NOT TESTED: there is no Coq here (Debian packages coq, libcoq-flocq)")
        return 77
    folder.mkdir(parents=True, exist_ok=True)
    for proof in HERE.glob("*.v"):
        (folder / proof.name).write_text(ASSUMPTIONS.sub("", proof.read_text()))
    names = sorted(p.stem for p in HERE.glob("*.v") if p.stem not in LEMMAS and not p.stem.endswith("_body"))
    changed = [name for name in names if is_new(name, folder)]
    if said("lemmas", folder, [], lambda: lemmas_by_coq(folder)) is None:
        return 1
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        results = list(pool.map(lambda name: check_coq(name, folder), names))
    print(f"{len(changed)} of {len(names)} proofs are new or changed, the others were accepted before")
    return 0 if results and all(results) and check_assumptions(names, folder) else 1


def run_gappa():
    if not shutil.which("gappa"):
        print("NOT TESTED: there is no Gappa here (Debian package gappa)")
        return 77
    good = bool(list(HERE.glob("*.g")))
    for proof in sorted(HERE.glob("*.g")):
        made = subprocess.run(["gappa", str(proof)], capture_output=True, text=True)
        if made.returncode != 0 or "error" in made.stderr.lower():
            print(f"{proof.name}: Gappa refuses it\n{made.stdout}{made.stderr}")
            good = False
        else:
            print(f"{proof.name}: proved")
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(run_coq(Path(sys.argv[2])) if sys.argv[1] == "coq" else run_gappa())
