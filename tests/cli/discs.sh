# discs are a method of their own, pullpush is the image pyramid; the older names of discs draw the same pictures and say so once
python3 -c 'from check import *; ball("in/ball.mha")'
isorender in/ball.mha --isovalue 500 --points ball.ply --no-image --quiet
draw() { # NAME OPTION..: of the volume, and of its points
    local name=$1
    shift
    isorender in/ball.mha $name.png --isovalue 500 --resolution 90x70 --json=$name.json "$@" 2>$name.said
    isorender ball.ply file_$name.png --resolution 90x70 --json=file_$name.json "$@" 2>file_$name.said
}
draw discs --method discs
draw curved --method discs --reconstruction curved
draw flat --method discs --reconstruction flat
draw splats --method splats --reconstruction flat
draw old_curved --method pullpush --reconstruction curved
draw old_flat --method pullpush --reconstruction flat
draw quiet --method pullpush --reconstruction curved --quiet
draw pullpush --method pullpush
draw gaussian --method pullpush --reconstruction gaussian
draw box --method pullpush --reconstruction box
python3 - <<'P'
from check import *
for kind in "", "file_":
    names = "discs curved flat splats old_curved old_flat quiet pullpush gaussian box".split()
    of = {name: report(kind + name + ".json") for name in names}
    pictures = {name: of[name]["image"]["hash"] for name in names}
    expect(pictures["discs"] == pictures["curved"] == pictures["old_curved"] == pictures["quiet"], kind, pictures)
    expect(pictures["flat"] == pictures["old_flat"] == pictures["splats"], kind, pictures)
    expect(pictures["pullpush"] == pictures["gaussian"], kind, pictures)
    expect(len({pictures[name] for name in ("discs", "flat", "pullpush", "box")}) == 4, kind, pictures)
    drawn = {name: (of[name]["method"], of[name]["reconstruction"]) for name in names}
    expect(drawn["discs"] == drawn["old_curved"] == ("discs", "curved"), kind, drawn)
    expect(drawn["flat"] == drawn["old_flat"] == ("discs", "flat"), kind, drawn)
    expect(drawn["pullpush"] == ("pullpush", "gaussian") and drawn["box"] == ("pullpush", "box"), kind, drawn)
    for name in names:
        said = open(kind + name + ".said").read()
        wanted = 1 if name.startswith("old_") else 0
        expect(said.count("older name of --method discs") == wanted, kind, name, said)
P
isorender_refuses 2 "--method pullpush has --reconstruction gaussian or box" in/ball.mha --method pullpush --reconstruction ewa
isorender_refuses 2 "--method discs has --reconstruction curved or flat" in/ball.mha --method discs --reconstruction box
isorender_refuses 2 "--reconstruction flat is for --method discs or splats" in/ball.mha --reconstruction flat
isorender_refuses 2 "--one-pyramid is for --method pullpush or hybrid" in/ball.mha --method discs --one-pyramid
