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

# The same atoms in mmCIF: one column after the other in any order, quoted names, comments, alternate locations, a second model.
python3 - <<'P'
tags = "group_PDB id type_symbol label_atom_id label_alt_id label_comp_id auth_asym_id auth_seq_id Cartn_x Cartn_y Cartn_z B_iso_or_equiv pdbx_PDB_model_num".split()
rows = []
for k, line in enumerate(open("in/small.pdb")):
    name = line[12:16].strip()
    rows.append(dict(zip(tags, [line[:6].strip(), str(k), line[76:78].strip(), "'%s'" % name, ".", "ALA", "A", line[22:26].strip(),
                                *(line[c:c + 8].strip() for c in (30, 38, 46)), "20.00", "1"])))

def cif(path, order, rows, before="data_x\n", after="#\n_cell.a 1\nloop_\n_a.b\n_a.c\n1 2\n"):
    text = before + "_x.title\n;loop_\n_atom_site.id 1\n;\nloop_\n" + "".join("_atom_site.%s\n" % t for t in order)
    open("in/" + path, "w").write(text + "".join(" ".join(r[t] for t in order) + "\n" for r in rows) + after)

cif("same.cif", tags, rows)
cif("order.mmcif", tags[::-1], rows)
other = [dict(r, label_alt_id="B", Cartn_x="50") for r in rows]
cif("alternates.cif", tags, [x for r, o in zip(rows, other) for x in (dict(r, label_alt_id="A"), o)])
cif("models.cif", tags, rows + [dict(r, pdbx_PDB_model_num="2", Cartn_x="50") for r in rows])
cif("lines.cif", tags, [dict(r, label_atom_id="\n;%s\n;\n" % r["label_atom_id"][1:-1], Cartn_y=r["Cartn_y"] + "(3)") for r in rows])
cif("cut.cif", tags, rows, after="ATOM 41 C\n")
cif("quote.cif", tags, rows, after="ATOM 41 C 'CA\n")
cif("text.cif", tags, rows, after="ATOM 41 C\n;CA\n")
cif("word.cif", tags, [dict(rows[0], Cartn_z="?")])
cif("none.cif", tags[:8], rows)
cif("other.cif", tags, rows, before="%PDF\n")
open("in/crystal.cif", "w").write("data_c\nloop_\n_atom_site_label\n_atom_site_fract_x\nC1 0.5\n")
open("in/wide.cif", "w").write("data_w\nloop_\n" + "".join("_atom_site.c%d\n" % i for i in range(257)) + "1\n")
P
for name in same.cif order.mmcif alternates.cif models.cif lines.cif; do
    isorender --glyphs in/$name $name.png --resolution 80x80 --json=$name.json >$name.log 2>&1
done
grep -q '40 alternate locations are left out' alternates.cif.log
grep -q 'further models follow: only the first is read' models.cif.log
python3 - <<'P'
from check import *
names = "small same.cif order.mmcif alternates.cif models.cif lines.cif".split()
hashes = {n: report(n + ".json")["image"]["hash"] for n in names}
expect(len(set(hashes.values())) == 1, hashes)
P
refuse_cif() { isorender_refuses "$1" "in/$3: $2" --glyphs "in/$3"; } # STATUS TEXT FILE
refuse_cif 3 'truncated' cut.cif
refuse_cif 3 'truncated' quote.cif
refuse_cif 3 'truncated' text.cif
refuse_cif 3 'atom 1 has no three coordinates' word.cif
refuse_cif 3 'holds no atoms: there is no loop of _atom_site with Cartn_x, y and z' none.cif
refuse_cif 3 'not a .cif file' other.cif
refuse_cif 3 'its atoms have fractional coordinates: obabel' crystal.cif
refuse_cif 3 'a loop has more than 256 columns' wide.cif
