#!/usr/bin/env python3
"""Damaged files against the programs.

usage: hostile.py PROGRAMS SOURCE [--cases N] [--seed S] [--only LABEL] [--attacks] [--keep FOLDER]

PROGRAMS is the folder with isorender, isosculpt and isocompare, SOURCE the project's. Every case is a small valid
file (seeds.py) with one kind of damage: flipped bits, an end that is missing, numbers and words of its header
replaced, lines of it doubled, dropped or swapped, numbers of its binary part replaced by ones that lie. Half as many
cases again, or all if N is at least ATTACKS_FROM, are the attacks of attacks.py. Whatever a file holds or is, a
program must end by itself with an allowed status, say what is wrong in one line of printable UTF-8, leave nothing
behind, and keep to its time and to the memory that it was allowed. Cases that fail are kept.
"""
import argparse
import concurrent.futures
import json
import os
import random
import re
import resource
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import threading

sys.dont_write_bytecode = True
import attacks as attack_kinds  # noqa: E402
import seeds as seed_files  # noqa: E402
from seeds import crc32c  # noqa: E402

LIMIT = 64 << 20  # of --max-memory
SLACK = 64 << 20  # beside it
ATTACKS_FROM = 5000
WAIT = 60  # seconds, by the clock, after which a program hangs
SECONDS = 4  # of processor time; two are asked for on a machine at rest
NUMBERS = [b"0", b"-1", b"1", b"nan", b"inf", b"-inf", b"1e300", b"-1e300", b"1e-300", b"1e-30", b"2147483647", b"2147483648",
           b"-2147483648", b"4294967296", b"99999999999999999999", b"1e39", b"", b"0x10", b"1.5", b"65536", b"1" * 400]
WORDS = [b"x" * 1000, b"%n%n%s", b"\x1b[31m", b"\xff\xfe", b"../../../etc/passwd", b"/dev/zero", b"\n", b"\0", b"\"", b"short",
         b"double", b"block", b"LIST", b"%d.raw 0 2147483647 1", b"big", b"ascii", b"gzip", b"bzip2", b"<", b">", b"&lt;"]
PATTERNS = [b"\0", b"\xff", b"\x7f", b"\x80", b"\0\0", b"\xff\xff", b"\xff\x7f", b"\x7f\xff", b"\0\0\0\0", b"\xff\xff\xff\xff",
            b"\xff\xff\xff\x7f", b"\x7f\xff\xff\xff", b"\0\0\0\x80", b"\x80\0\0\0", b"\xff" * 8, b"\xff" * 7 + b"\x7f",
            struct.pack("<f", float("nan")), struct.pack("<f", float("inf")), struct.pack("<f", 1e38), struct.pack("<d", 1e300),
            struct.pack(">f", float("nan")), struct.pack(">d", 1e300)]


def repair_strokes(data):
    """Right checksums for the lines of a damaged stroke file, so that what they hold is looked at."""
    lines = []
    for line in data.split(b"\n"):
        at = line.rfind(b',"crc":"')
        lines.append(line[:at] + b',"crc":"%08x"}' % crc32c(line[:at]) if at >= 0 else line)
    return b"\n".join(lines)


# ---- damage

def flip_bits(data, rng):
    data = bytearray(data)
    reach = min(len(data), 512) if rng.random() < 0.5 else len(data)
    for _ in range(rng.choice((1, 1, 2, 8))):
        data[rng.randrange(reach)] ^= 1 << rng.randrange(8)
    return bytes(data)


def truncate(data, rng):
    return data[: rng.randrange(len(data))]


def lie(data, rng):
    pattern = rng.choice(PATTERNS)
    reach = min(len(data), 512) if rng.random() < 0.5 else len(data)
    at = rng.randrange(reach)
    return data[:at] + pattern + data[at + len(pattern) :]


def replace_token(data, rng, expression, choices):
    found = list(re.finditer(expression, data[:8192]))
    if not found:
        return flip_bits(data, rng)
    token = rng.choice(found)
    return data[: token.start()] + rng.choice(choices) + data[token.end() :]


def replace_number(data, rng):
    return replace_token(data, rng, rb"-?\d+(\.\d+)?(e-?\d+)?", NUMBERS)


def replace_word(data, rng):
    return replace_token(data, rng, rb"[A-Za-z_.]{2,}", WORDS)


def change_lines(data, rng):
    head, tail = data[:8192], data[8192:]
    lines = head.split(b"\n")
    at, other = rng.randrange(len(lines)), rng.randrange(len(lines))
    kind = rng.randrange(4)
    if kind == 0:
        lines[at : at + 1] = [lines[at]] * rng.choice((2, 3, 2000))
    elif kind == 1:
        del lines[at]
    elif kind == 2:
        lines[at], lines[other] = lines[other], lines[at]
    else:
        lines[at] = lines[at] + rng.choice(WORDS)
    return b"\n".join(lines) + tail


DAMAGE = [flip_bits, truncate, lie, replace_number, replace_word, change_lines]


def damage(seed, rng):
    """The files of a case, by name."""
    files = dict(seed.files)
    name = seed.names[0] if rng.random() < 0.8 else rng.choice(seed.names)
    data = files[name]
    for _ in range(rng.choice((1, 1, 1, 2))):
        if data:
            data = rng.choice(DAMAGE)(data, rng)
    if name.endswith(".strokes") and rng.random() < 0.9:
        data = repair_strokes(data)
    files[name] = data
    return files


# ---- a case

class Wrong(Exception):
    pass


class Slow(Wrong):
    """More processor time than is allowed, in a run whose processor may have been shared with others."""


def command_of(programs, seed):
    first = seed.names[0].split("/")[0]
    words = seed.program.split()
    command = [os.path.join(programs, words[0])] + words[1:]
    if words[0] == "isosculpt":
        command += seed.arguments + [first]
    else:
        command += [first] + seed.arguments
    if seed.program == "isocompare images":
        command += ["b.png"]
    if seed.program != "isosculpt" or "--open" in seed.arguments:
        command += ["--max-memory", "64M"]
    return command + ["--quiet", "--threads", "1"] + (["--json"] if seed.program != "isocompare report" else [])


def write_files(folder, files):
    for name, data in files.items():
        path = os.path.join(folder, name)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, "wb") as file:
            file.write(data)


def tree(folder):
    return sorted(os.path.relpath(os.path.join(base, name), folder) for base, _, names in os.walk(folder) for name in names)


def limit_resources():
    resource.setrlimit(resource.RLIMIT_CPU, (SECONDS + 2, SECONDS + 3))
    resource.setrlimit(resource.RLIMIT_FSIZE, (1 << 28, 1 << 28))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def run(command, folder, tmp):
    """Status, output, error text, and what the process used."""
    with open(os.path.join(tmp, "stdout"), "w+b") as out, open(os.path.join(tmp, "stderr"), "w+b") as err:
        os.mkdir(os.path.join(tmp, "tmp"))
        environment = dict(os.environ, TMPDIR=os.path.join(tmp, "tmp"), LC_ALL="C")
        child = subprocess.Popen(command, cwd=folder, stdin=subprocess.DEVNULL, stdout=out, stderr=err, env=environment,
                                 preexec_fn=limit_resources)
        hangs = threading.Timer(WAIT, lambda: os.kill(child.pid, signal.SIGALRM))
        hangs.start()
        _, status, usage = os.wait4(child.pid, 0)
        hangs.cancel()
        child.returncode = status
        out.seek(0)
        err.seek(0)
        return status, out.read(), err.read(), usage


def check_text(text, failed):
    try:
        decoded = text.decode("utf-8")
    except UnicodeDecodeError:
        raise Wrong("what it says is not UTF-8")
    if any(ord(c) < 32 and c != "\n" or 127 <= ord(c) < 160 for c in decoded):
        raise Wrong("what it says has control characters")
    if failed and (decoded.count("\n") != 1 or not decoded.endswith("\n") or len(decoded) < 15):
        raise Wrong("not one line of explanation")


def without_scene(data):
    """A PNG without the text that has the fingerprint of its input; other files as they are."""
    at = data.find(b"tEXtScene\0") - 4
    if not data.startswith(b"\x89PNG") or at < 0:
        return data
    return data[:at] + data[at + 12 + int.from_bytes(data[at : at + 4], "big") :]


def result_of(folder, there, out):
    """What a program has made: its files, or else what it has printed, less what differs from run to run."""
    made = {name: without_scene(open(os.path.join(folder, name), "rb").read()) for name in tree(folder) if name not in there}
    return made or re.sub(rb'"(seconds|peak_bytes|[a-z_]*seconds)": *([0-9.e+-]+|{[^}]*})', b"", out)


def check_case(command, folder, tmp, before, baseline, attack=None, whole=None):
    there = tree(folder)
    status, out, err, usage = run(command, folder, tmp)
    if os.WIFSIGNALED(status) and os.WTERMSIG(status) == signal.SIGALRM:
        raise Wrong("hangs")
    if os.WIFSIGNALED(status):
        raise Wrong("killed by %s" % signal.Signals(os.WTERMSIG(status)).name)
    code = os.WEXITSTATUS(status)
    # A level set whose class was damaged is a volume like any other, which isosculpt asks an isovalue for.
    is_volume_now = code == 2 and "--open" in command and b" needs --isovalue" in err
    if code not in (attack.statuses if attack else (0, 3, 5, 6)) and not is_volume_now:
        raise Wrong("status %d: %s" % (code, err[:300]))
    check_text(err, code != 0)
    if code != 0 and out:
        raise Wrong("output though it failed")
    if code == 0 and "--json" in command:
        json.loads(out, parse_constant=lambda c: (_ for _ in ()).throw(Wrong("%s in JSON" % c)))
    seconds = usage.ru_utime + usage.ru_stime
    if seconds > SECONDS:
        raise Slow("%.1f seconds of processor time" % seconds)
    if usage.ru_maxrss * 1024 > max(LIMIT, baseline) + SLACK:
        raise Wrong("%d MiB of memory" % (usage.ru_maxrss >> 10))
    if os.listdir(os.path.join(tmp, "tmp")):
        raise Wrong("left in TMPDIR: %s" % os.listdir(os.path.join(tmp, "tmp")))
    left = [name for name in tree(folder) if name not in there]
    if code != 0 and left:
        raise Wrong("left behind: %s" % left)
    for name, data in before.items():
        with open(os.path.join(folder, name), "rb") as file:
            if file.read() != data:
                raise Wrong("changed its input %s" % name)
    if code == 0 and attack and attack.cut and result_of(folder, there, out) != whole:
        raise Wrong("another result than that of the whole file, and no error")


def one_case(programs, seed, number, root, keep, baseline):
    """None, or what is wrong."""
    rng = random.Random("%d %s %d" % (root, seed.label, number))
    return play(programs, seed, "case %d" % number, damage(seed, rng), keep, baseline)


def one_attack(programs, seed, attack, keep, undamaged_seed):
    baseline, whole = undamaged_seed
    return play(programs, seed, attack.label, attack.files, keep, baseline, attack, whole)


def play(programs, seed, label, files, keep, baseline, attack=None, whole=None):
    command = command_of(programs, seed)
    if attack and attack.command:
        attack.command(command)

    def make(folder):
        os.makedirs(folder)
        write_files(folder, files)
        if attack and attack.make:
            attack.make(folder)

    def attempt():
        tmp = tempfile.mkdtemp(prefix="hostile-")
        folder = os.path.join(tmp, "case")
        try:
            make(folder)
            check_case(command, folder, tmp, files, baseline, attack, whole)
        finally:
            shutil.rmtree(tmp, ignore_errors=True)

    try:
        try:
            attempt()
        except Slow:
            attempt()  # the faster of two runs counts
        return None
    except Wrong as wrong:
        if keep:
            kept = os.path.join(keep, re.sub("[ /%]+", "-", "%s-%s" % (seed.label, label.replace("case ", ""))))
            shutil.rmtree(kept, ignore_errors=True)
            make(kept)
            return "%s, %s: %s\n    cd %s && %s" % (seed.label, label, wrong, kept, " ".join(command))
        return "%s, %s: %s" % (seed.label, label, wrong)


def undamaged(programs, seed):
    """The memory that the whole file takes, and its result; a seed that cannot be read would show nothing."""
    tmp = tempfile.mkdtemp(prefix="hostile-")
    folder = os.path.join(tmp, "case")
    try:
        write_files(folder, seed.files)
        there = tree(folder)
        status, out, err, usage = run(command_of(programs, seed), folder, tmp)
        result = usage.ru_maxrss * 1024, result_of(folder, there, out)
        if os.WIFEXITED(status) and os.WEXITSTATUS(status) == 6:
            return result  # read, and has no surface
        if status != 0:
            if b"built without" in err:
                return None
            sys.exit("%s: the undamaged file fails: %s" % (seed.label, err.decode(errors="replace")))
        return result
    finally:
        shutil.rmtree(tmp, ignore_errors=True)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("programs")
    parser.add_argument("source")
    parser.add_argument("--cases", type=int, default=400)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", default="")
    parser.add_argument("--attacks", action="store_true", help="all attacks, as for %d cases" % ATTACKS_FROM)
    parser.add_argument("--keep")
    options = parser.parse_args()
    programs = os.path.abspath(options.programs)
    with tempfile.TemporaryDirectory() as folder:
        seeds = [s for s in seed_files.make(programs, os.path.abspath(options.source), folder) if options.only in s.label]
    whole = {}
    for seed in list(seeds):
        whole[seed.label] = undamaged(programs, seed)
        if whole[seed.label] is None:
            seeds.remove(seed)
    attacks = [(seed, attack) for seed in seeds for attack in attack_kinds.make(seed)]
    if options.cases < ATTACKS_FROM and not options.attacks:
        attacks = random.Random(options.seed).sample(attacks, min(len(attacks), options.cases // 2))
    keep = os.path.abspath(options.keep) if options.keep else None
    wrong = []
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        cases = [pool.submit(one_case, programs, seeds[i % len(seeds)], i, options.seed, keep, whole[seeds[i % len(seeds)].label][0])
                 for i in range(options.cases)]
        cases += [pool.submit(one_attack, programs, seed, attack, keep, whole[seed.label]) for seed, attack in attacks]
        for case in concurrent.futures.as_completed(cases):
            if case.result():
                wrong.append(case.result())
                print(case.result(), flush=True)
    print("%d cases and %d attacks on %d files, %d wrong (seed %d)" % (options.cases, len(attacks), len(seeds), len(wrong), options.seed))
    return 1 if wrong or not seeds else 0


if __name__ == "__main__":
    sys.exit(main())
