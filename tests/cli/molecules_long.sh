# Molecules whose numbers outgrow their columns: one digit more shifts what stands behind it, letters and digits do not. The atoms
# must come out as those of the same file with small numbers. A file that lacks what its format ends with is refused.
python3 - <<'P'
import math
def atoms(path, serial, residue, head=(), tail=(), every=1):
    with open("in/%s.pdb" % path, "w") as f:
        f.writelines(line + "\n" for line in head)
        for k in range(40):
            name, element = ((" N  ", " N"), (" CA ", " C"), (" O  ", " O"), ("CA  ", "CA"))[k % 4]
            x, y, z = (9 * math.cos(k), 9 * math.sin(k), k / 2 - 10)
            kind = "HETATM" if k % 4 == 3 else "ATOM  "
            f.write("%s%s %s ALA A%s    %8.3f%8.3f%8.3f  1.00 20.00          %s\n" % (kind, serial(k), name, residue(k), x, y, z, element))
        f.writelines(line + "\n" for line in tail)
atoms("small", lambda k: "%5d" % k, lambda k: "%4d" % k)
atoms("residues", lambda k: "%5d" % k, lambda k: "%4d" % (9990 + k))
atoms("serials", lambda k: "%5d" % (99990 + k), lambda k: "%4d" % k)
atoms("both", lambda k: "%5d" % (999990 + k), lambda k: "%4d" % (99990 + k))
atoms("hybrid", lambda k: "A%04d" % k, lambda k: "A%03d" % k)
atoms("entry", lambda k: "%5d" % k, lambda k: "%4d" % k, head=["HEADER    PROTEIN"], tail=["END"])
atoms("no_end", lambda k: "%5d" % k, lambda k: "%4d" % k, head=["HEADER    PROTEIN"])
atoms("model", lambda k: "%5d" % k, lambda k: "%4d" % k, head=["MODEL        1"], tail=["ENDMDL"])
atoms("no_endmdl", lambda k: "%5d" % k, lambda k: "%4d" % k, head=["MODEL        1"])
open("in/second.pdb", "w").write(open("in/model.pdb").read() + open("in/no_endmdl.pdb").read())
open("in/head.pdb", "w").write("HEADER    PROTEIN\nREMARK   1 CUT\n")
open("in/wide.pdb", "w").write(open("in/small.pdb").read().replace("ATOM      ", "ATOM 10000"))
P
for name in small residues serials both hybrid entry model wide; do
    isorender --glyphs in/$name.pdb $name.png --quiet --resolution 80x80 --json=$name.json
done
python3 - <<'P'
from check import *
names = "small residues serials both hybrid entry model wide".split()
hashes = {n: report(n + ".json")["image"]["hash"] for n in names}
expect(len(set(hashes.values())) == 1, hashes)
P
isorender_refuses 3 "truncated: it has no END record" --glyphs in/no_end.pdb
isorender_refuses 3 "truncated: it has no END record" --glyphs in/head.pdb
isorender_refuses 3 "truncated: it has no ENDMDL record" --glyphs in/no_endmdl.pdb
isorender_refuses 3 "truncated: it has no ENDMDL record" --glyphs in/second.pdb
