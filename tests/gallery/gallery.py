"""Runs every command of docs/gallery.md, in its order, in a folder that is made anew, and draws each picture again from itself
to the same bytes. gallery.py BIN ROOT OUT: the folders of the programs and of the project, and the one for what is made."""
import os
import re
import shutil
import subprocess
import sys


def run(command, folder, programs):
    """Runs a command in bash; ends the program if it fails."""
    path = programs + os.pathsep + os.environ["PATH"]
    done = subprocess.run(["bash", "-euo", "pipefail", "-c", command], cwd=folder, env=dict(os.environ, PATH=path), text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    if done.returncode:
        sys.exit("exit %d: %s\n%s" % (done.returncode, command, done.stdout))


def main():
    programs, root, out = (os.path.abspath(path) for path in sys.argv[1:4])
    with open(os.path.join(root, "docs", "gallery.md"), encoding="utf-8") as page:
        commands = re.findall(r"^    (\S.*)$", page.read(), re.M)
    shutil.rmtree(out, ignore_errors=True)
    os.makedirs(out)
    for name in os.listdir(os.path.join(root, "volumes")):
        if not name.endswith(".md"):
            shutil.copy(os.path.join(root, "volumes", name), out)
    probe = subprocess.run([os.path.join(programs, "isosculpt"), "--replay", "bear.strokes", "--headless", "--quiet", "--output",
                            "probe.vdb"], cwd=out, capture_output=True, text=True)
    if probe.returncode:
        print("skipped: built without OpenVDB:", probe.stderr.strip())
        sys.exit(77)
    for command in commands:
        run(command, out, programs)
    pictures = sorted(set(re.findall(r"\b\w+\.png\b", "\n".join(commands))))
    if len(pictures) < 20:
        sys.exit("%d pictures were found in the gallery: nothing was checked" % len(pictures))
    for name in pictures:
        run("isorender --again %s -o again.png --quiet && cmp %s again.png" % (name, name), out, programs)
    print("%d commands, %d pictures" % (len(commands), len(pictures)))


main()
