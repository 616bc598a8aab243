# Extensions in capitals open as those in small letters do, as inputs and as values of options.
cat >in/cube.stl <<'T'
solid a
facet normal 0 0 1
outer loop
vertex 0 0 0
vertex 10 0 0
vertex 0 10 0
endloop
endfacet
facet normal 0 0 1
outer loop
vertex 0 0 0
vertex 0 10 0
vertex 0 0 10
endloop
endfacet
endsolid a
T
printf '1 1 0 0 0 2 -1\n2 3 10 0 0 2 1\n3 3 10 10 5 1 2\n' >in/n.swc
printf 'ATOM      1  N   MET A   1      20.154  29.699   5.276  1.00 49.05           N\nATOM      2  CA  MET A   1      21.154  31.699   6.276  1.00 49.05           C\nEND\n' >in/p.pdb
cp in/p.pdb in/e.ent
printf 'x,y,z,radius\n0,0,0,1\n3,1,2,1\n' >in/c.csv
printf '2\nmolecule\nC 0 0 0\nO 1 1 0\n' >in/m.xyz
printf '0 0 0\n1 0 0\n0 1 0\n0 0 1\n' >in/s.xyz
printf '# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS 3 float\n0 0 0 1 0 0 1 2 3\nLINES 1 4\n3 0 1 2\n' >in/l.vtk
cat >in/v.vtp <<'T'
<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian"><PolyData>
<Piece NumberOfPoints="3" NumberOfLines="1"><Points><DataArray type="Float32" NumberOfComponents="3" format="ascii">0 0 0 1 0 0 1 2 3</DataArray></Points>
<Lines><DataArray type="Int32" Name="connectivity" format="ascii">0 1 2</DataArray><DataArray type="Int32" Name="offsets" format="ascii">3</DataArray></Lines>
</Piece></PolyData></VTKFile>
T
python3 - <<'P'
import struct
points = struct.pack("<9f", 0, 0, 0, 5, 0, 0, 5, 5, 5) + struct.pack("<3f", *[float("nan")] * 3) + struct.pack("<3f", *[float("inf")] * 3)
open("in/t.tck", "wb").write(b"mrtrix tracks\ndatatype: Float32LE\ncount: 1\nfile: . 68\nEND\n".ljust(68, b"\n") + points)
header = bytearray(1000)
header[:6] = b"TRACK\0"
struct.pack_into("<3h3f", header, 6, 10, 10, 10, 1, 1, 1)
struct.pack_into("<16f", header, 440, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1)
header[948:951] = b"RAS"
struct.pack_into("<iii", header, 988, 1, 2, 1000)
open("in/k.trk", "wb").write(header + struct.pack("<i", 3) + struct.pack("<9f", 1, 1, 1, 5, 1, 1, 5, 5, 5))
P
for file in cube.stl n.swc t.tck k.trk v.vtp l.vtk p.pdb e.ent c.csv m.xyz s.xyz; do
    name=${file%.*} extension=${file##*.}
    upper=in/$name.${extension^^}
    cp "in/$file" "$upper"
    isorender "in/$file" small.png --resolution 24x24 -q
    isorender "$upper" large.png --resolution 24x24 -q
    cmp <(python3 -c 'from check import *; print(Png("small.png").rows)') <(python3 -c 'from check import *; print(Png("large.png").rows)')
done
isorender 'in/cube.stl' surface.png --resolution 24x24 -q --lines in/n.SWC --glyphs in/p.PDB --surface in/cube.STL
