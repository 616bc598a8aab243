# Points in text as spreadsheets and CloudCompare write it: names in quotes or with blanks, decimal commas, a byte order mark.
python3 - <<'P'
import math
points = [(9 * math.cos(k), 9 * math.sin(2 * k), 8 * math.sin(k), k, 200 - k, 90, k / 4) for k in range(60)]
def write(name, head, row, mark=""):
    with open("in/" + name, "w", encoding="utf-8", newline="") as f:
        f.write(mark + head + "".join(row(p) + "\n" for p in points))
def joined(separator, comma=False):
    return lambda p: separator.join(("%.4f" % v).replace(".", "," if comma else ".") for v in p)
write("plain.txt", "x y z r g b M3C2_distance\n", joined(" "))
write("quoted.txt", '"X","Y","Z","R","G","B","M3C2 distance"\n', joined(","))
write("quoted_blanks.txt", '"X" "Y" "Z" "R" "G" "B" "M3C2 distance"\n', joined(" "))
write("unquoted.txt", "X,Y,Z,R,G,B,M3C2 distance\n", joined(","))
write("mark.txt", "X;Y;Z;R;G;B;M3C2 distance\n", joined(";"), mark="\ufeff")
write("commas.txt", "X;Y;Z;R;G;B;M3C2 distance\n", joined(";", True))
write("commas_tab.txt", "X\tY\tZ\tR\tG\tB\tM3C2 distance\n", joined("\t", True))
write("commas.csv", "X;Y;Z;R;G;B;M3C2 distance\n", joined(";", True))
write("bare.xyz", "", lambda p: "%.4f %.4f %.4f" % p[:3])
write("bare_commas.xyz", "", lambda p: ("%.4f %.4f %.4f" % p[:3]).replace(".", ","))
write("bare_mark.xyz", "", lambda p: "%.4f %.4f %.4f" % p[:3], mark="\ufeff")
write("unit.txt", "X [m]\tY [m]\tZ [m]\tR\tG\tB\tM3C2 distance\n", joined("\t"))
write("comment.csv", "//X,Y,Z,R,G,B,M3C2 distance\n", joined(","))
write("paraview.csv", '"Points:0","Points:1","Points:2","R","G","B","M3C2 distance"\n', joined(","))
write("survey.csv", "Easting,Northing,Elevation,R,G,B,M3C2 distance\n", joined(","))
write("names.csv", "a,b,c,R,G,B,M3C2 distance\n", joined(","))
write("plain.csv", "x,y,z,R,G,B,M3C2 distance\n", joined(","))
open("in/wide.xyz", "w", encoding="utf-16").write("1 2 3\n")
open("in/rubbish.csv", "w").write("x,y,z\n1,2,3\n4,3.1+e2,6\n")
open("in/missing.csv", "w").write("x,y,z\n1,2,3\n4,,6\n4,NA,6\n7,8, 9 \n")
open("in/late.txt", "w").write("X;Y;Z\n1;2;3\n1,5;2,5;3,5\n")
P
for name in plain.txt plain.csv unit.txt comment.csv paraview.csv survey.csv quoted.txt quoted_blanks.txt unquoted.txt mark.txt commas.txt commas_tab.txt bare.xyz bare_commas.xyz bare_mark.xyz; do
    isorender in/$name picture.png --quiet --resolution 60x60 --json=$name.json
done
isorender in/commas.csv picture.png --quiet --resolution 60x60 --columns x,y,z,r,g,b,heat --json=commas.csv.json
python3 - <<'P'
from check import *
def hashes(*names):
    return {report(n + ".json")["image"]["hash"] for n in names}
tables = hashes("plain.csv", "comment.csv", "paraview.csv", "survey.csv")
named = hashes("plain.txt", "unit.txt", "quoted.txt", "quoted_blanks.txt", "unquoted.txt", "mark.txt", "commas.txt", "commas_tab.txt", "commas.csv")
bare = hashes("bare.xyz", "bare_commas.xyz", "bare_mark.xyz")
expect(len(tables) == 1, tables)
expect(len(named) == 1 and len(bare) == 1 and named != bare, named, bare)
P
isorender --info in/quoted.txt | grep -q 'M3C2 distance: 0 .. 14.75'
isorender --info in/late.txt | grep -q 'bounds *1 2 3 .. 1.5 2.5 3.5'
isorender_refuses 3 "UTF-16" in/wide.xyz
isorender_refuses 3 "rubbish.csv: row 3: a coordinate has something behind its number" in/rubbish.csv
isorender in/missing.csv missing.png --resolution 60x60 2>&1 | grep -q 'note: 2 positions are not finite'
isorender_refuses 3 "names.csv: its points have no x: their columns are 'a', 'b', 'c', 'R', .* (--columns names those of a table)" in/names.csv
