# exit: 3
# stderr: isorender: in/a.vti: two arrays of CellData are named "values"
# VTK finds arrays by name, and crashed with many that have one name.
python3 - <<'P'
array = '<DataArray type="Int16" Name="values" NumberOfComponents="1" format="appended" offset="0"/>\n'
with open("in/a.vti", "wb") as file:
    file.write(b'<?xml version="1.0"?>\n<VTKFile type="ImageData" version="0.1" byte_order="BigEndian">\n'
               b'<ImageData WholeExtent="2 6 -1 2 0 2" Origin="0 3 3" Spacing="0.5 1 2"><Piece Extent="2 6 -1 2 0 2">\n'
               b'<CellData Scalars="values">\n' + 2000 * array.encode() + b'</CellData></Piece></ImageData>\n'
               b'<AppendedData encoding="raw">\n_\0\0\0\x30' + bytes(range(48)) + b'\n</AppendedData>\n</VTKFile>\n')
P
isorender in/a.vti out.png
