"""Runs every command of docs/gallery.md, docs/gallery-figures.md (which draws the scenes of docs/gallery) and of the tutorials, page by
page in its order, in a folder that is made anew, and draws each picture of the gallery again from itself to the same bytes. gallery.py BIN ROOT OUT: the folders of the programs and of the
project, and the one for what is made; the tutorials' folders are beside it."""
import glob
import json
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


def missing_file(command, root, out):
    """Links what the scene of a command reads and does not ship, if it is beside the project; returns the name of a file that is not."""
    for name in re.findall(r"\bfig_\w+\.json\b", command):
        with open(os.path.join(out, name), encoding="utf-8") as text:
            scene = json.load(text)
        reads = [scene.get("input", "")] + [value for option in scene["options"] for key, value in option.items()
                                            if key in ("lines", "glyphs", "surface", "volume", "surface-color-by") and ":" not in value and "." in value]
        for file in reads:
            here = os.path.join(out, os.path.basename(file))
            if not file or file.startswith("scene:") or os.path.exists(here):
                continue
            found = glob.glob(os.path.join(root, "..", "shared", "*", "*", os.path.basename(file)))
            if not found:
                return os.path.basename(file)
            os.symlink(os.path.abspath(found[0]), here)
    return None


def run_pages(pages, programs, root, out):
    """Runs the commands of pages in the folder `out` with what ships in volumes/ and docs/gallery, and returns them, but for those
    whose scenes read what is not there."""
    commands = []
    for page in pages:
        with open(page, encoding="utf-8") as text:
            commands += re.findall(r"^    (\S.*)$", text.read(), re.M)
    shutil.rmtree(out, ignore_errors=True)
    os.makedirs(out)
    for folder in "volumes", "docs/gallery":
        for name in os.listdir(os.path.join(root, folder)):
            if not name.endswith(".md"):
                shutil.copy(os.path.join(root, folder, name), out)
    done = []
    for command in commands:
        missing = missing_file(command, root, out)
        if missing:
            print("skipped: there is no %s for: %s" % (missing, command))
            continue
        run(command, out, programs)
        done.append(command)
    return done


def main():
    programs, root, out = (os.path.abspath(path) for path in sys.argv[1:4])
    os.makedirs(out, exist_ok=True)
    probe = subprocess.run([os.path.join(programs, "isosculpt"), "--replay", os.path.join(root, "volumes/bear.strokes"), "--headless",
                            "--quiet", "--output", "probe.vdb"], cwd=out, capture_output=True, text=True)
    if probe.returncode:
        print("skipped: built without OpenVDB:", probe.stderr.strip())
        sys.exit(77)
    scenes = glob.glob(os.path.join(root, "docs", "gallery", "*.json"))
    for scene in scenes:
        with open(scene, encoding="utf-8") as text:
            if text.read().count("\n") > 15:
                sys.exit("%s has more than 15 lines" % scene)
    pages = [os.path.join(root, "docs", name) for name in ("gallery.md", "gallery-figures.md")]
    commands = run_pages(pages, programs, root, out)
    for scene in scenes:
        with open(pages[1], encoding="utf-8") as text:
            if "isorender %s " % os.path.basename(scene) not in text.read():
                sys.exit("%s is on no page" % scene)
        if "../../volumes/" in open(scene, encoding="utf-8").read(): # from where it lies in the project, too
            run("isorender %s -o checkout.png --quiet --resolution 64x64" % scene, out, programs)
    pictures = sorted(set(re.findall(r"\b\w+\.png\b", "\n".join(commands))))
    if len(pictures) < 20:
        sys.exit("%d pictures were found in the gallery: nothing was checked" % len(pictures))
    for name in pictures:
        run("isorender --again %s -o again.png --quiet && cmp %s again.png" % (name, name), out, programs)
    tutorials = glob.glob(os.path.join(root, "docs", "tutorial-*.md"))
    for page in tutorials:
        count = len(run_pages([page], programs, root, out + "-" + os.path.basename(page)[:-3]))
        if count < 4:
            sys.exit("%s: only %d commands were found" % (page, count))
    print("%d commands and %d pictures of the gallery, %d tutorials" % (len(commands), len(pictures), len(tutorials)))


main()
