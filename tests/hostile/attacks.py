"""Attacks beside damage: what is no file where one is opened or made, and files that end early.

Each takes the files of a seed to a folder and says which statuses are right, how the program is called, and whether what it
writes must be what it writes for the whole file.
"""
import os

# Formats without a count or an end, of which a part is a whole file.
ENDLESS = (".csv", ".xyz", ".txt", ".asc", ".pts", ".pwn", ".swc", ".obj", ".strokes", ".pdb", ".ent")
INSTEAD = ("fifo", "loop", "dangling", "device", "folder")
PERCENT = range(5, 100, 5)


class Attack:
    def __init__(self, label, files, statuses, make=None, command=None, cut=False):
        self.label, self.files, self.statuses, self.cut = label, files, statuses, cut
        self.make = make  # make(folder): what is no file
        self.command = command  # changes the words of the command, in place


def put(kind, path, target):
    """Something that is no regular file, or leads to another one."""
    os.makedirs(os.path.dirname(path), exist_ok=True)
    if kind == "fifo":
        os.mkfifo(path)
    elif kind == "folder":
        os.mkdir(path)
    elif kind == "device":
        os.symlink("/dev/zero", path)
    elif kind == "loop":
        os.symlink(os.path.basename(path), path)
    elif kind == "dangling":
        os.symlink("missing", path)
    else:
        os.symlink(os.path.relpath(target, os.path.dirname(path)), path)


def is_main(seed, name):
    """Whether a file is the main input, which may be a FIFO or a device with an end."""
    words = seed.program.split()
    further = words[0] == "isosculpt" or seed.program == "isocompare images" or words[-1] in ("--lines", "--glyphs", "--environment")
    return name == seed.names[0] and "/" not in name and not further


def instead_of_inputs(seed):
    """A FIFO, a device .. where a file is read. Folders may be read without them."""
    for name in seed.names:
        for kind in INSTEAD:
            if is_main(seed, name) and kind in ("fifo", "device"):
                continue
            files = {other: data for other, data in seed.files.items() if other != name}
            yield Attack("%s instead of %s" % (kind, name), files, (0, 3, 5, 6) if "/" in name else (2, 3),
                         lambda folder, kind=kind, name=name: put(kind, os.path.join(folder, name), None))


def instead_of_outputs(seed):
    """Outputs that lead to the input are refused."""
    outputs = [word for word in seed.arguments if word in ("out.png", "out.stl", "out.ply")]
    for name in outputs:
        for target in [n for n in seed.names if not n.endswith("DICOMDIR")][:1]: # (which is not read)
            yield Attack("%s leads to %s" % (name, target), seed.files, (2,),
                         lambda folder, name=name, target=target: put("link", os.path.join(folder, name), os.path.join(folder, target)))


def draw_part(command):
    command[command.index("out.png")] = "out.isokeys"
    command[1:1] = ["--part", "1/2"]


def instead_of_the_index(seed):
    """The index of a volume is a file that nobody has asked for."""
    if seed.program != "isorender" or seed.label.startswith("isorender points") or "out.png" not in seed.arguments:
        return
    first = seed.names[0].split("/")[0]
    for kind in INSTEAD + ("link",):
        yield Attack("%s as the index" % kind, seed.files, (0, 2, 3, 5, 6),
                     lambda folder, kind=kind: put(kind, os.path.join(folder, first + ".isoindex"), os.path.join(folder, seed.names[0])),
                     draw_part)


def cut_short(seed):
    """Files that end early: refused, or what is missing does not show, where the format lets one know."""
    if seed.program == "isocompare report":
        return
    for name in seed.names:
        if name.endswith(ENDLESS):
            continue
        if "dicom" in seed.label and len(seed.files) > 1:
            continue  # cut before its series is said, it is another file of the folder, which a note leaves out
        for percent in PERCENT:
            data = seed.files[name]
            yield Attack("%s cut at %d %%" % (name, percent), dict(seed.files, **{name: data[:len(data) * percent // 100]}),
                         (0, 2, 3, 5, 6), cut=True)


def make(seed):
    return [attack for kind in (instead_of_inputs, instead_of_outputs, instead_of_the_index, cut_short) for attack in kind(seed)]
