"""Small valid files of every format that the programs read, as the beginning of damaged ones."""
import base64
import gzip
import io
import lzma
import os
import struct
import subprocess
import sys
import zipfile
import zlib

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "cli"))
from check import crc32c  # noqa: E402

VOXELS = [max(0, 255 - 12 * ((x - 5) ** 2 + (y - 5) ** 2 + (z - 4) ** 2)) for z in range(9) for y in range(11) for x in range(10)]
DIMS = (10, 11, 9)


class Seed:
    """Files by name, of which `names[0]` is what a program is given; `text` bytes of it are a header in text."""

    def __init__(self, label, files, program, arguments=()):
        self.label, self.files, self.program, self.arguments = label, files, program, list(arguments)
        self.names = list(files)


def dicom_element(group, element, kind, value):
    if len(value) % 2:
        value += b"\0" if kind == b"UI" else b" "
    long_form = kind in (b"OB", b"OW", b"SQ", b"UN", b"UT")
    length = b"\0\0" + struct.pack("<I", len(value)) if long_form else struct.pack("<H", len(value))
    return struct.pack("<HH", group, element) + kind + length + value


def dicom_file(number, frames=1, time=0):
    """Slice `number`, and `frames` - 1 after it; its instance number tells at what time it was taken."""
    x, y, _ = DIMS
    pixels = VOXELS[number * x * y : (number + frames) * x * y]
    meta = dicom_element(2, 0x10, b"UI", b"1.2.840.10008.1.2.1")
    meta = dicom_element(2, 0, b"UL", struct.pack("<I", len(meta))) + meta
    data = b"".join(
        dicom_element(*e)
        for e in (
            (8, 0x16, b"UI", b"1.2.840.10008.5.1.4.1.1.2"), (8, 0x18, b"UI", b"1.2.3.%d" % (number + 1)),
            (8, 0x60, b"CS", b"CT"), (0x18, 0x50, b"DS", b"1.5"), (0x20, 0xD, b"UI", b"1.2.3"),
            (0x20, 0xE, b"UI", b"1.2.3.4"), (0x20, 0x13, b"IS", b"%d" % (number + 10 * time)),
            (0x20, 0x32, b"DS", b"-5\\-5\\%g" % (1.5 * number)), (0x20, 0x37, b"DS", b"1\\0\\0\\0\\1\\0"),
            (0x28, 2, b"US", struct.pack("<H", 1)), (0x28, 4, b"CS", b"MONOCHROME2"),
            (0x28, 8, b"IS", b"%d" % frames), (0x28, 0x10, b"US", struct.pack("<H", y)),
            (0x28, 0x11, b"US", struct.pack("<H", x)), (0x28, 0x30, b"DS", b"0.5\\0.5"),
            (0x28, 0x100, b"US", struct.pack("<H", 16)), (0x28, 0x101, b"US", struct.pack("<H", 16)),
            (0x28, 0x102, b"US", struct.pack("<H", 15)), (0x28, 0x103, b"US", struct.pack("<H", 0)),
            (0x28, 0x1052, b"DS", b"-100"), (0x28, 0x1053, b"DS", b"2"),
            (0x7FE0, 0x10, b"OW", struct.pack("<%dH" % len(pixels), *pixels)),
        )
    )
    return b"\0" * 128 + b"DICM" + meta + data


def png_chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def png_file(size, rows, depth=8, color=0, chunks=(), interlaced=False):
    """The bytes of a PNG file. rows: for each row of the image, or of each of the seven passes of an interlaced one, the bytes of
    its samples. color: PNG's type, 0 grey, 2 RGB, 3 palette, 4 grey and opacity, 6 RGBA. chunks: (kind, data) before the pixels."""
    header = struct.pack(">IIBBBBB", *size, depth, color, 0, 0, int(interlaced))
    pixels = zlib.compress(b"".join(b"\0" + row for row in rows))
    return b"\x89PNG\r\n\x1a\n" + b"".join(png_chunk(*c) for c in ((b"IHDR", header), *chunks, (b"IDAT", pixels), (b"IEND", b"")))


def png_slice(z):
    x, y, _ = DIMS
    at = z * x * y
    return png_file((x, y), [bytes(VOXELS[at + x * row:at + x * row + x]) for row in range(y)],
                    chunks=[(b"pHYs", struct.pack(">IIB", 2000, 2000, 1))])


def tiff_file(slices, description=b""):
    """Slices of the voxels, uncompressed, each with a header in front of it; the first has a description."""
    x, y, _ = DIMS
    data = b"II*\0" + struct.pack("<I", 8)
    for number, z in enumerate(slices):
        text = description + b"\0" if description and number == 0 else b""
        entries = [(256, 3, 1, x), (257, 3, 1, y), (258, 3, 1, 8), (259, 3, 1, 1), (262, 3, 1, 1), (277, 3, 1, 1),
                   (278, 3, 1, y), (279, 4, 1, x * y)]
        begin = len(data)
        after = begin + 2 + 12 * (len(entries) + 1 + bool(text)) + 4
        if text:
            entries.append((270, 2, len(text), after))
        entries.append((273, 4, 1, after + len(text)))
        end = after + len(text) + x * y
        data += struct.pack("<H", len(entries)) + b"".join(struct.pack("<HHII", *e) for e in sorted(entries))
        data += struct.pack("<I", end if number + 1 < len(slices) else 0) + text + bytes(VOXELS[x * y * z:x * y * (z + 1)])
    return data


def nifti_header(magic, offset):
    header = bytearray(348)
    struct.pack_into("<i", header, 0, 348)
    struct.pack_into("<8h", header, 40, 3, *DIMS, 1, 1, 1, 1)
    struct.pack_into("<hh", header, 70, 2, 8)
    struct.pack_into("<8f", header, 76, 1, 0.5, 0.5, 1.5, 0, 0, 0, 0)
    struct.pack_into("<3f", header, 108, offset, 1, 0)
    header[123] = 2
    header[344:348] = magic
    return bytes(header)


def exr_attribute(name, kind, value):
    return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value


def exr_file(width, height):
    """An uncompressed OpenEXR picture with the channels B, G and R, all 0.5."""
    channels = b"".join(name + b"\0" + struct.pack("<iiii", 2, 0, 1, 1) for name in (b"B", b"G", b"R")) + b"\0"
    window = struct.pack("<iiii", 0, 0, width - 1, height - 1)
    header = struct.pack("<II", 20000630, 2) + b"".join((
        exr_attribute("channels", "chlist", channels), exr_attribute("compression", "compression", b"\0"),
        exr_attribute("dataWindow", "box2i", window), exr_attribute("displayWindow", "box2i", window),
        exr_attribute("lineOrder", "lineOrder", b"\0"), exr_attribute("pixelAspectRatio", "float", struct.pack("<f", 1)),
        exr_attribute("screenWindowCenter", "v2f", struct.pack("<ff", 0, 0)),
        exr_attribute("screenWindowWidth", "float", struct.pack("<f", 1)))) + b"\0"
    row = struct.pack("<%df" % (3 * width), *[0.5] * (3 * width))
    first = len(header) + 8 * height
    offsets = b"".join(struct.pack("<Q", first + y * (8 + len(row))) for y in range(height))
    return header + offsets + b"".join(struct.pack("<ii", y, len(row)) + row for y in range(height))


def written(programs, folder, name, *command):
    """The bytes that a program writes to `name`."""
    path = os.path.join(folder, name)
    subprocess.run([os.path.join(programs, command[0]), *command[1:], path, "--quiet"], check=True, cwd=folder)
    with open(path, "rb") as file:
        return file.read()


def zarr_chunk(z):
    """Voxels of the chunk of 3 x 11 x 10 that begins at slice 3 * z."""
    return bytes(VOXELS[330 * z:330 * z + 330])


def zarr_files():
    """Zarr v2 with OME metadata and zlib, and v3 with a shard. The first file names the folder."""
    scales = b'"multiscales":[{"version":"0.4","axes":[{"name":"z","type":"space","unit":"millimeter"},{"name":"y",' \
             b'"type":"space","unit":"millimeter"},{"name":"x","type":"space","unit":"millimeter"}],"datasets":[{"path":"0",' \
             b'"coordinateTransformations":[{"type":"scale","scale":[1.5,0.5,0.5]},{"type":"translation","translation":[1,2,3]}]}]}]'
    array = b'{"zarr_format":2,"shape":[9,11,10],"chunks":[3,11,10],"dtype":"|u1","order":"C","fill_value":0,"filters":null,' \
            b'"dimension_separator":".","compressor":{"id":"zlib","level":1}}'
    yield "v2", {".zattrs": b"{" + scales + b"}", "0/.zarray": array,
                 **{"0/%d.0.0" % z: zlib.compress(zarr_chunk(z)) for z in range(3)}}
    codecs = b'{"name":"bytes","configuration":{"endian":"little"}},{"name":"crc32c"}'
    header = b'{"zarr_format":3,"node_type":"array","shape":[9,11,10],"data_type":"uint8","chunk_grid":{"name":"regular",' \
             b'"configuration":{"chunk_shape":[9,11,10]}},"chunk_key_encoding":{"name":"default","configuration":{"separator":"/"}},' \
             b'"fill_value":0,"codecs":[{"name":"sharding_indexed","configuration":{"chunk_shape":[3,11,10],"codecs":[' + codecs + \
             b'],"index_codecs":[' + codecs + b']}}]}'
    parts = [zarr_chunk(z) + struct.pack("<I", crc32c(zarr_chunk(z))) for z in range(3)]
    index = b"".join(struct.pack("<QQ", 334 * z, 334) for z in range(3))
    yield "v3", {"zarr.json": header, "c/0/0/0": b"".join(parts) + index + struct.pack("<I", crc32c(index))}


def field_files():
    """Maps, FreeSurfer's and MRtrix's volumes, orbitals and potentials."""
    voxels = bytes(v // 2 for v in VOXELS)
    head = bytearray(1024)
    struct.pack_into("<10i6f3i", head, 0, *DIMS, 0, 1, 2, 3, *DIMS, 5, 5.5, 13.5, 90, 100, 90, 1, 2, 3)
    struct.pack_into("<2i", head, 88, 1, 80)
    head[208:216] = b"MAP \x44\x44\0\0"
    yield "mrc", {"a.mrc": bytes(head) + b"\0" * 80 + voxels}
    yield "map.gz", {"a.map.gz": gzip.compress(bytes(head) + b"\0" * 80 + voxels, mtime=0)}
    head = struct.pack(">7ih15f", 1, *DIMS, 1, 0, 0, 1, 0.5, 0.5, 1.5, -1, 0, 0, 0, 0, -1, 0, 1, 0, 1, 2, 3).ljust(284, b"\0")
    yield "mgh", {"a.mgh": head + voxels}
    yield "mgz", {"a.mgz": gzip.compress(head + voxels, mtime=0)}
    mif = b"mrtrix image\ndim: 10,11,9\nvox: 0.5,0.5,1.5\nlayout: -1,+0,+2\ndatatype: UInt8\ntransform: 1,0,0,4\n" \
          b"transform: 0,1,0,5\ntransform: 0,0,1,6\n"
    yield "mif", {"a.mif": (mif + b"file: . 256\nEND\n").ljust(256, b"\0") + voxels}
    yield "mih", {"a.mih": mif + b"file: b.dat\nEND\n", "b.dat": voxels}
    attribute = lambda name, *v: b"\ntype = float-attribute\nname = %s\ncount = %d\n %s\n" % (
        name, len(v), b" ".join(b"%g" % n for n in v))
    yield "afni", {"a+orig.HEAD": attribute(b"DATASET_RANK", 3, 1) + attribute(b"DATASET_DIMENSIONS", *DIMS) + attribute(b"BRICK_TYPES", 0)
                   + attribute(b"BRICK_FLOAT_FACS", 0.5) + attribute(b"IJK_TO_DICOM_REAL", 1, 0, 0, 4, 0, 1, 0, 5, 0, 0, 1, 6)
                   + b"\ntype = string-attribute\nname = BYTEORDER_STRING\ncount = 10\n'LSB_FIRST~\n", "a+orig.BRIK": voxels}
    numbers = ("\n".join(" ".join("%.4e" % v for v in VOXELS[i:i + 6]) for i in range(0, len(VOXELS), 6)) + "\n").encode()
    yield "cube", {"a.cube": b"an orbital\n\n-1 1 2 3\n9 1 0 0\n11 0 1 0\n10 0 0.5 1\n6 6 1 2 3\n1 7\n" + numbers}
    yield "chgcar", {"a.vasp": b"density\n1.0\n10 0 0\n0 11 0\n0 0.5 9\nC H\n1 1\nDirect\n0 0 0\n0.5 0.5 0.5\n\n10 11 9\n" + numbers}
    yield "dx", {"a.dx": b"object 1 class gridpositions counts 9 11 10\norigin 1 2 3\ndelta 1 0 0\ndelta 0 1 0\ndelta 0 0.5 1\n"
                         b"object 2 class gridconnections counts 9 11 10\n"
                         b"object 3 class array type double rank 0 items 990 data follows\n" + numbers}


def npy(values, shape, fortran=False):
    head = b"{'descr': '<f4', 'fortran_order': %s, 'shape': %s, }" % (str(fortran).encode(), str(shape).encode())
    head += b" " * (-(11 + len(head)) % 64) + b"\n"
    return b"\x93NUMPY\1\0" + struct.pack("<H", len(head)) + head + struct.pack("<%df" % len(values), *values)


def npz(how):
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", how) as archive:
        for name, data in (("a", npy([1, 2], (2,))), ("v", npy(VOXELS, DIMS[::-1])), ("f", npy(VOXELS, DIMS[::-1], True))):
            with archive.open(zipfile.ZipInfo(name + ".npy"), "w", force_zip64=True) as member:
                member.write(data)
    return file.getvalue()


def vtk_xml(kind, inside, more=""):
    return ('<VTKFile type="%s" version="0.1" byte_order="LittleEndian"%s>%s</VTKFile>' % (kind, more, inside)).encode()


def lz4_literals(data):
    """A block of LZ4 that repeats nothing."""
    return b"\xf0" + b"\xff" * ((len(data) - 15) // 255) + bytes([(len(data) - 15) % 255]) + data


VTK_PACKERS = {"zlib": zlib.compress, "lz4": lz4_literals, "lzma": lzma.compress}


def vtr(how):
    """A rectilinear grid with an uneven axis: text, zlib, LZ4 or LZMA in base64, or appended."""
    arrays = [("v", [float(v) for v in VOXELS])] + [(axis, [k + (k > 5) * 0.5 for k in range(n)]) for axis, n in zip("xyz", DIMS)]
    tags, appended = [], b""
    for name, values in arrays:
        data = struct.pack("<%df" % len(values), *values)
        body = ' format="ascii">%s</DataArray>' % " ".join(map(str, values))
        if how in VTK_PACKERS:
            packed = VTK_PACKERS[how](data)
            head = struct.pack("<4I", 1, len(data), 0, len(packed))
            body = ' format="binary">%s</DataArray>' % (base64.b64encode(head) + base64.b64encode(packed)).decode()
        if how == "raw":
            body = ' format="appended" offset="%d"/>' % len(appended)
            appended += struct.pack("<I", len(data)) + data
        tags.append('<DataArray type="Float32" Name="%s"' % name + body)
    box = "0 %d 0 %d 0 %d" % tuple(n - 1 for n in DIMS)
    text = vtk_xml("RectilinearGrid", '<RectilinearGrid WholeExtent="%s"><Piece Extent="%s"><PointData Scalars="v">%s</PointData><Coordinates>%s'
                   "</Coordinates></Piece></RectilinearGrid>%s" % (box, box, tags[0], "".join(tags[1:]), "<AppendedData/>" if appended else ""),
                   ' compressor="vtk%sDataCompressor"' % {"zlib": "ZLib"}.get(how, how.upper()) if how in VTK_PACKERS else "")
    return text.replace(b"<AppendedData/>", b'<AppendedData encoding="raw">_' + appended + b"</AppendedData>")


def amira(kind):
    head = "# AmiraMesh %s\ndefine Lattice 10 11 9\nParameters { BoundingBox 0 4.5 0 5 0 12,\n CoordType \"uniform\" }\n" \
           "Lattice { byte L } @1%s\nLattice { short D } @2%s\n@1\n"
    shorts = struct.pack("<990h", *VOXELS)
    runs = b"".join(bytes((1, v)) for v in VOXELS[:400]) + b"\x7f\0" * 4 + b"\x01\0" * 82
    if kind == "text":
        return (head % ("3D ASCII 2.0", "", "")).encode() + (" ".join(map(str, VOXELS)) + "\n@2\n" + " ".join(map(str, VOXELS)) + "\n").encode()
    if kind == "zip":
        packed = zlib.compress(shorts)
        return (head % ("BINARY-LITTLE-ENDIAN 2.1", "(HxByteRLE,%d)" % len(runs), "(HxZip,%d)" % len(packed))).encode() + runs + b"\n@2\n" + packed + b"\n"
    return (head % ("BINARY-LITTLE-ENDIAN 2.1", "", "")).encode() + bytes(VOXELS) + b"\n@2\n" + shorts + b"\n"


def xdmf(topology, geometry, form, text):
    return ('<?xml version="1.0"?><Xdmf Version="2.0"><Domain><Grid Name="g"><Topology TopologyType="%s" Dimensions="9 11 10"/><Geometry '
            'GeometryType="%s</Geometry><Attribute Name="v"><DataItem Dimensions="9 11 10" NumberType="UChar" Format="%s">%s</DataItem>'
            "</Attribute></Grid></Domain></Xdmf>" % (topology, geometry, form, text)).encode()


def format_files():
    """Archives of NumPy, VTK's other files, Amira's and XDMF's: those of one file, which the fuzzer has as well."""
    yield "npz", {"a.npz": npz(zipfile.ZIP_STORED)}
    yield "npz-deflated", {"a.npz": npz(zipfile.ZIP_DEFLATED)}
    for how in ("text", "raw", *VTK_PACKERS):
        yield "vtr-" + how, {"a.vtr": vtr(how)}
    for kind in ("text", "zip", "plain"):
        yield "am-" + kind, {"a.am": amira(kind)}
    items = lambda *rows: "".join('<DataItem Dimensions="%d" Format="XML">%s</DataItem>' % (len(row), " ".join(map(str, row))) for row in rows)
    numbers = " ".join(map(str, VOXELS))
    yield "xdmf-even", {"a.xdmf": xdmf("3DCoRectMesh", 'ORIGIN_DXDYDZ">' + items((1, 2, 3), (1.5, 0.5, 0.5)), "XML", numbers)}
    uneven = [[k + (k > 5) * 0.5 for k in range(n)] for n in DIMS]
    yield "xdmf-uneven", {"a.xdmf": xdmf("3DRectMesh", 'VXVYVZ">' + items(*uneven), "XML", numbers)}


def parts_files():
    """The same, of several files."""
    box = "0 %d 0 %d 0 %d" % tuple(n - 1 for n in DIMS)
    image = vtk_xml("ImageData", '<ImageData WholeExtent="%s"><Piece Extent="%s"><PointData Scalars="v"><DataArray type="UInt8" Name="v" format="ascii">%s '
                    "</DataArray></PointData></Piece></ImageData>" % (box, box, " ".join(map(str, VOXELS))))
    yield "pvti", {"a.pvti": vtk_xml("PImageData", '<PImageData WholeExtent="%s" Spacing="1 1 1.5"><PPointData Scalars="v"><PDataArray type="UInt8" '
                                     'Name="v"/></PPointData><Piece Extent="%s" Source="b.vti"/></PImageData>' % (box, box)), "b.vti": image}
    yield "pvd", {"a.pvd": vtk_xml("Collection", '<Collection><DataSet timestep="0" file="b.vti"/><DataSet timestep="1" file="b.vti"/></Collection>'),
                  "b.vti": image}
    yield "vtm", {"a.vtm": vtk_xml("vtkMultiBlockDataSet", '<vtkMultiBlockDataSet><DataSet index="0" name="b" file="b.vti"/></vtkMultiBlockDataSet>'),
                  "b.vti": image}
    yield "xdmf-raw", {"a.xdmf": xdmf("3DCoRectMesh", 'ORIGIN_DXDYDZ"><DataItem Dimensions="3" Format="XML">1 2 3</DataItem><DataItem Dimensions="3" '
                                      'Format="XML">1 1 1</DataItem>', "Binary", "b.raw"), "b.raw": bytes(VOXELS)}


def volume_seeds():
    voxels = bytes(VOXELS)
    nrrd = b"NRRD0004\ntype: uint8\ndimension: 3\nsizes: 10 11 9\nspace: left-posterior-superior\n" \
           b"space directions: (0.5,0,0) (0,0.5,0) (0,0,1.5)\nspace origin: (1,2,3)\nkey:=value\n"
    mhd = b"ObjectType = Image\nNDims = 3\nDimSize = 10 11 9\nElementType = MET_UCHAR\nElementSpacing = 0.5 0.5 1.5\n" \
          b"Offset = 1 2 3\nTransformMatrix = 1 0 0 0 1 0 0 0 1\n"
    yield "nrrd", {"a.nrrd": nrrd + b"encoding: raw\n\n" + voxels}
    yield "nrrd-gzip", {"a.nrrd": nrrd + b"encoding: gzip\n\n" + gzip.compress(voxels, mtime=0)}
    yield "nhdr", {"a.nhdr": nrrd + b"encoding: raw\ndata file: b.raw\n", "b.raw": voxels}
    yield "nhdr-list", {"a.nhdr": nrrd + b"encoding: raw\ndata file: LIST 2\n" + b"".join(b"b%d.raw\n" % z for z in range(9)),
                        **{"b%d.raw" % z: voxels[110 * z : 110 * z + 110] for z in range(9)}}
    yield "nhdr-pattern", {"a.nhdr": nrrd + b"encoding: raw\ndata file: b%d.raw 0 8 1 2\n",
                           **{"b%d.raw" % z: voxels[110 * z : 110 * z + 110] for z in range(9)}}
    yield "mhd", {"a.mhd": mhd + b"ElementDataFile = b.raw\n", "b.raw": voxels}
    yield "mha", {"a.mha": mhd + b"ElementDataFile = LOCAL\n" + voxels}
    yield "hdr", {"a.hdr": nifti_header(b"ni1\0", 0), "a.img": voxels}
    yield "nii", {"a.nii": nifti_header(b"n+1\0", 352) + b"\0" * 4 + voxels}
    yield "nii.gz", {"a.nii.gz": gzip.compress(nifti_header(b"n+1\0", 352) + b"\0" * 4 + voxels, mtime=0)}
    yield "tiff", {"a.tif": tiff_file(range(9), b"ImageJ=1.53t\nimages=9\nslices=9\nunit=mm\nspacing=1.5\n")}
    yield "tiff-folder", {"a/%d.tif" % z: tiff_file([z]) for z in range(9)}
    yield "png-folder", {"a/%d.png" % z: png_slice(z) for z in range(9)}
    yield from field_files()
    yield from format_files()
    yield from parts_files()
    for label, files in zarr_files():
        yield "zarr-" + label, {"a.zarr/" + name: data for name, data in files.items()}
    yield "dicom", {"a.dcm": dicom_file(0, 9)}
    yield "dicom-seg", {"a.dcm": dicom_segmentation()}
    yield "dicom-folder", {"a/%d.dcm" % z: dicom_file(z) for z in range(4)}
    yield "dicom-times", {"a/%d-%d.dcm" % (time, z): dicom_file(z, time=time) for time in range(2) for z in range(4)}
    kind = dicom_element(2, 2, b"UI", b"1.2.840.10008.1.3.10") + dicom_element(2, 0x10, b"UI", b"1.2.840.10008.1.2.1")
    yield "dicom-cd", {"a/DICOMDIR": b"\0" * 128 + b"DICM" + dicom_element(2, 0, b"UL", struct.pack("<I", len(kind))) + kind,
                       **{"a/b/%d" % z: dicom_file(z) for z in range(4)}}


def dicom_segmentation():
    """A BINARY segmentation of two segments of 10 x 11 x 4 voxels."""
    number = lambda value: struct.pack("<H", value)
    items = lambda *sets: b"".join(struct.pack("<HHI", 0xFFFE, 0xE000, len(s)) + s for s in sets)
    nested = lambda group, tag, *sets: dicom_element(group, tag, b"SQ", items(*sets))
    segments = [dicom_element(0x62, 4, b"US", number(i)) + dicom_element(0x62, 5, b"LO", b"part %d" % i)
                + dicom_element(0x62, 0xD, b"US", number(40000) + number(50000) + number(30000)) for i in (1, 2)]
    frames = [nested(0x20, 0x9113, dicom_element(0x20, 0x32, b"DS", b"0\\0\\%d" % (2 * z)))
              + nested(0x62, 0xA, dicom_element(0x62, 0xB, b"US", number(i))) for i in (1, 2) for z in range(4)]
    shared = (nested(0x20, 0x9116, dicom_element(0x20, 0x37, b"DS", b"1\\0\\0\\0\\1\\0"))
              + nested(0x28, 0x9110, dicom_element(0x18, 0x88, b"DS", b"2") + dicom_element(0x28, 0x30, b"DS", b"1\\1")))
    meta = dicom_element(2, 0x10, b"UI", b"1.2.840.10008.1.2.1")
    data = (dicom_element(8, 0x60, b"CS", b"SEG") + dicom_element(0x28, 2, b"US", number(1))
            + dicom_element(0x28, 8, b"IS", b"8") + dicom_element(0x28, 0x10, b"US", number(11))
            + dicom_element(0x28, 0x11, b"US", number(10))
            + b"".join(dicom_element(0x28, 0x100 + i, b"US", number(v)) for i, v in enumerate((1, 1, 0, 0)))
            + dicom_element(0x62, 1, b"CS", b"BINARY") + nested(0x62, 2, *segments) + nested(0x5200, 0x9229, shared)
            + nested(0x5200, 0x9230, *frames) + dicom_element(0x7FE0, 0x10, b"OB", bytes(i * 37 % 256 for i in range(110))))
    return b"\0" * 128 + b"DICM" + dicom_element(2, 0, b"UL", struct.pack("<I", len(meta))) + meta + data


def corpus_seeds(corpus):
    """The fuzzer's files, less their first byte, which chooses how it reads them.."""
    for name in sorted(os.listdir(corpus)):
        if name.startswith(("mha", "nii", "vti", "vtk", "h5")):
            with open(os.path.join(corpus, name), "rb") as file:
                yield name, {"a." + name.split("-")[0]: file.read()[1:]}


def object_seeds(source, kind, option, picture):
    """Files of lines or glyphs: their fuzzer's, less those that are damaged already."""
    corpus = os.path.join(source, "tests/fuzz/corpus", kind)
    for name in sorted(os.listdir(corpus)):
        if name in ("cycle.swc", "short.pdb"):
            continue
        with open(os.path.join(corpus, name), "rb") as file:
            yield Seed("isorender %s %s" % (kind, name), {"a." + name.rsplit(".", 1)[1]: file.read()[1:]},
                       "isorender " + option, picture)


def gaussians_file():
    """Four 3-D Gaussians, as trainers write them."""
    names = "x y z f_dc_0 f_dc_1 f_dc_2 f_rest_0 opacity scale_0 scale_1 scale_2 rot_0 rot_1 rot_2 rot_3".split()
    header = "ply\nformat binary_little_endian 1.0\nelement vertex 4\n"
    header += "".join("property float %s\n" % name for name in names) + "end_header\n"
    return header.encode() + b"".join(
        struct.pack("<15f", i, 2 * i % 3, i % 2, 0.5, -0.5, i, 9, 2 - i, -1, 0, -0.5, 1, 0.5, i, 0) for i in range(4))


def point_seeds(source, picture):
    """Files of points as the input: the fuzzer's of glyphs, and some whose columns are named."""
    points = (".ply", ".pcd", ".las", ".laz", ".npy", ".pts", ".pwn", ".off", ".obj")
    for seed in object_seeds(source, "glyphs", "--glyphs", picture):
        if seed.names[0].endswith(points) or "ten.xyz" in seed.label or "points.xyz" in seed.label:
            yield Seed(seed.label.replace("glyphs", "points"), seed.files, "isorender", picture)
    yield Seed("isorender points gaussians", {"a.ply": gaussians_file()}, "isorender", picture)
    yield Seed("isorender points edl", {"a.ply": gaussians_file()}, "isorender --method discs --shading edl", picture)
    rows = b"1 2 3 0.5 7\n4 5 6 0.25 8\n7 8 8 0.75 9\n"
    yield Seed("isorender points columns", {"a.xyz": rows}, "isorender --columns x,y,z,-,heat", picture)
    yield Seed("isorender points table", {"a.csv": rows.replace(b" ", b",")}, "isorender --columns x,y,z,-,heat", picture)


def make(programs, source, folder):
    """All seeds. `source` is the project's folder, `folder` one for what programs write."""
    picture = ["-o", "out.png", "--resolution", "24x24"]
    volumes = list(volume_seeds()) + list(corpus_seeds(os.path.join(source, "tests/fuzz/corpus/volumes")))
    try:
        volumes.append(("vdb", {"a.vdb": written(programs, folder, "s.vdb", "isosculpt", "--replay",
                                                 os.path.join(source, "tests/hostile/ball.strokes"), "--headless", "-o")}))
    except subprocess.CalledProcessError:
        pass  # built without OpenVDB
    seeds = [Seed("isorender " + label, files, "isorender", picture) for label, files in volumes]
    seeds += [Seed("isosculpt " + label, files, "isosculpt",
                   (["--isovalue", "100"] if label != "vdb" else []) + ["--headless", "-o", "out.stl", "--open"])
              for label, files in volumes if label in ("nrrd", "nhdr", "dicom", "vdb", "nii", "tiff")]
    seeds += [Seed("isocompare " + label, files, "isocompare report", ["--side", "64", "--output", "out"])
              for label, files in volumes if label in ("nrrd", "mhd")]
    points = written(programs, folder, "p.ply", "isorender", "scene:sphere:16", "--no-image", "--points")
    seeds.append(Seed("isorender ply", {"a.ply": points}, "isorender", picture))
    seeds += object_seeds(source, "lines", "--lines", picture)
    seeds += object_seeds(source, "glyphs", "--glyphs", picture)
    seeds += point_seeds(source, picture)
    for name in ("zlib.gii", "base64.gii", "freesurfer.pial", "nodes.glb", "models.3mf", "stored.3mf"):
        with open(os.path.join(source, "tests/fuzz/corpus/mesh", name), "rb") as file:
            seeds.append(Seed("isorender mesh " + name, {"a." + name.rsplit(".", 1)[1]: file.read()[1:]}, "isorender --surface", picture))
    flat = b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n" \
        b"property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"
    data = b'<GIFTI Version="1.0"><LabelTable><Label Key="1" Red="1" Green="0.5" Blue="0" Alpha="1">a</Label></LabelTable>' \
        b'<DataArray Intent="NIFTI_INTENT_LABEL" DataType="NIFTI_TYPE_INT32" Dim0="3" Encoding="ASCII"><MetaData><MD><Name>Name</Name>' \
        b"<Value>b</Value></MD></MetaData><Data>1 2 1</Data></DataArray></GIFTI>"
    for name, values in (("v.curv", b"\xff\xff\xff" + struct.pack(">3i3f", 3, 1, 1, 1, 2, 3)),
                         ("v.annot", struct.pack(">8i", 3, 0, 255, 1, 65280, 2, 0, 0)), ("v.gii", data)):
        seeds.append(Seed("isorender values " + name, {name: values, "a.ply": flat}, "isorender --surface-color-by", ["--surface", "a.ply"] + picture))
    for kind in ("stl", "ply", "obj"):
        mesh = written(programs, folder, "m." + kind, "isorender", "scene:sphere:16", "--no-image", "--mesh")
        seeds.append(Seed("isosculpt " + kind, {"a." + kind: mesh}, "isosculpt",
                          ["--headless", "-o", "out.stl", "--voxel-size", "1", "--open"]))
    with open(os.path.join(source, "tests/hostile/ball.strokes"), "rb") as file:
        seeds.append(Seed("isosculpt strokes", {"a.strokes": file.read()}, "isosculpt",
                          ["--headless", "-o", "out.ply", "--replay"]))
    png = written(programs, folder, "i.png", "isorender", "scene:sphere:16", "--resolution", "32x32", "-o")
    seeds.append(Seed("isocompare png", {"a.png": png, "b.png": png}, "isocompare images", []))
    try:
        jpeg = written(programs, folder, "i.jpg", "isorender", "scene:sphere:16", "--resolution", "20x17", "-o")
        seeds.append(Seed("isorender jpeg-folder", {"a/%d.jpg" % z: jpeg for z in range(3)}, "isorender", picture))
    except subprocess.CalledProcessError:
        pass  # built without libjpeg
    glass = "isorender --scene sphere:16 --ior 1.5 --environment"
    seeds.append(Seed("isorender environment", {"a.png": png}, glass, picture))
    light = os.path.join(folder, "light.exr")
    with open(light, "wb") as file:
        file.write(exr_file(8, 4))
    try:
        written(programs, folder, "e.png", "isorender", "scene:sphere:16", "--ior", "1.5", "--environment", light,
                "--resolution", "8x8", "-o")
        seeds.append(Seed("isorender exr", {"a.exr": exr_file(8, 4)}, glass, picture))
    except subprocess.CalledProcessError:
        pass  # built without OpenEXR
    return seeds
