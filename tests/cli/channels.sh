# Several channels of one file as surfaces in one picture (--channel): OME-TIFF and OME-Zarr give them names and colours, and
# isovalues, colours and opacities are dealt by channel.
python3 - <<'P'
import json
import os
import subprocess
from check import *
from tiff_files import tiff

SIDE, SLICES = 24, 12
# Of each channel: the middle of a ball, its value, and its name and colour as an OME-TIFF and an OME-Zarr state them.
BALLS = [(6, 100), (12, 160), (18, 240)]
NAMES = ["DAPI", "F-actin <R&D>", "GFP"]
COLORS = ["0000FF", "FF0000", "00C800"]


def plane(channel, z):
    x0, value = BALLS[channel]
    return bytes(max(0, value - 6 * ((x - x0) ** 2 + (y - 12) ** 2 + (2 * (z - 6)) ** 2)) for y in range(SIDE) for x in range(SIDE))


def signed(color):
    rgba = int(color + "FF", 16)
    return rgba - (1 << 32) if rgba >> 31 else rgba


def ome_tiff(path, channels):
    text = ('<?xml version="1.0"?><OME><Image ID="Image:0"><Pixels ID="Pixels:0" DimensionOrder="XYCZT" Type="uint8" SizeX="%d" SizeY="%d" '
            'SizeC="3" SizeZ="%d" SizeT="1" PhysicalSizeX="1" PhysicalSizeY="1" PhysicalSizeZ="2">%s<TiffData/></Pixels></Image></OME>' %
            (SIDE, SIDE, SLICES, "".join(channels)))
    tiff(path, (SIDE, SIDE), [plane(c, z) for z in range(SLICES) for c in range(3)], description=text)


def channel(number, name=None, color=None):
    name = name and name.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
    return '<Channel ID="Channel:0:%d" SamplesPerPixel="1"%s%s><LightPath/></Channel>' % (
        number, ' Name="%s"' % name if name else "", ' Color="%d"' % signed(color) if color else "")


def ome_zarr(path, version):
    """Axes c z y x, a chunk each channel."""
    attributes = {
        "multiscales": [{"version": "0.4", "axes": [{"name": "c", "type": "channel"}] +
                         [{"name": a, "type": "space", "unit": "micrometer"} for a in "zyx"],
                         "datasets": [{"path": "0", "coordinateTransformations": [{"type": "scale", "scale": [1, 2, 1, 1]}]}]}],
        "omero": {"channels": [{"label": name, "color": color, "window": {"start": 0, "end": 99}} for name, color in zip(NAMES, COLORS)]}}
    shape, chunks = [3, SLICES, SIDE, SIDE], [1, SLICES, SIDE, SIDE]
    files = {".zattrs": attributes, ".zgroup": {"zarr_format": 2},
             "0/.zarray": {"zarr_format": 2, "shape": shape, "chunks": chunks, "dtype": "|u1", "order": "C", "fill_value": 0, "filters": None,
                           "compressor": None, "dimension_separator": "/"}}
    if version == 3:
        files = {"zarr.json": {"zarr_format": 3, "node_type": "group", "attributes": {"ome": {"version": "0.5", **attributes}}},
                 "0/zarr.json": {"zarr_format": 3, "node_type": "array", "shape": shape, "data_type": "uint8", "fill_value": 0,
                                 "codecs": [{"name": "bytes"}], "attributes": {},
                                 "chunk_grid": {"name": "regular", "configuration": {"chunk_shape": chunks}},
                                 "chunk_key_encoding": {"name": "default", "configuration": {"separator": "/"}}}}
    for name, content in files.items():
        os.makedirs(os.path.dirname(os.path.join(path, name)), exist_ok=True)
        with open(os.path.join(path, name), "w") as file:
            json.dump(content, file)
    for c in range(3):
        folder = os.path.join(path, "0/c/%d/0/0" % c if version == 3 else "0/%d/0/0" % c)
        os.makedirs(folder)
        with open(folder + "/0", "wb") as file:
            file.write(b"".join(plane(c, z) for z in range(SLICES)))


def run(path, *options):
    done = subprocess.run(["isorender", path, "--resolution", "90x70", *options], capture_output=True, text=True)
    expect(done.returncode == 0, path, options, done)
    return done.stdout, done.stderr


def draw(path, *options):
    """The pixels, the report, and what is said."""
    said = run(path, "out.png", "--json=o.json", *options)[1]
    return Png("out.png").pixels(), report("o.json"), said


def surfaces(j):
    """Channel, name, isovalue, colour and opacity of the surfaces."""
    rows = [(j["volume"]["component"], j["volume"].get("channel"), j["isovalue"], j["colors"][0], j.get("opacities", [1])[0])]
    return rows + [(v["component"], v.get("channel"), v["isovalue"], v["color"], v["opacity"]) for v in j["volumes"]]


ome_tiff("in/cells.ome.tif", [channel(i, *stated) for i, stated in enumerate(zip(NAMES, COLORS))])
wanted, j, said = draw("in/cells.ome.tif", "--channel", "0,1,2")
rows = surfaces(j)
expect([(c, name, color) for c, name, _, color, _ in rows] == list(zip(range(3), NAMES, COLORS)), rows)
expect(len(set(v for _, _, v, _, _ in rows)) == 3, "an isovalue each", rows)
for c, name in enumerate(NAMES):
    expect("channel %d (%s): isovalue %g (Otsu" % (c, name, rows[c][2]) in said, c, said)
expect("--component" not in said and said.count("written by OME") == 1, said)
expect([(c["name"], c["color"]) for c in j["volume"]["channels"]] == list(zip(NAMES, COLORS)), j["volume"])

# It is the picture that --component and --volume-component make, in every method that draws further volumes.
for method in "exact", "raycast", "mesh", "discs", "pullpush", "points":
    by_channel = draw("in/cells.ome.tif", "--channel", "2,0,1", "--isovalue", "100,40,60", "--color", "ivory,navy,coral", "--method", method)[0]
    by_volume = draw("in/cells.ome.tif", "--component", "2", "--isovalue", "100", "--color", "ivory", "--method", method,
                     "--volume", "in/cells.ome.tif", "--volume-component", "0", "--volume-isovalue", "40", "--volume-color", "navy",
                     "--volume", "in/cells.ome.tif", "--volume-component", "1", "--volume-isovalue", "60", "--volume-color", "coral")[0]
    expect(by_channel == by_volume, method)

# Isovalues and opacities repeat the last one; channels without a given colour keep their own; --crop is of all.
j = draw("in/cells.ome.tif", "--channel", "1", "--channel", "0,2", "--isovalue", "50,30", "--opacity", "1,0.5", "--color", "navy",
         "--crop", "0,23,0,11,0,11")[1]
expect(surfaces(j) == [(1, NAMES[1], 50, "000080", 1), (0, NAMES[0], 30, COLORS[0], 0.5), (2, NAMES[2], 30, COLORS[2], 0.5)], surfaces(j))
expect(all(v["bounds_world"][3] <= 11e-3 for v in j["volumes"]), j["volumes"])
j = draw("in/cells.ome.tif", "--channel", "0,1,2", "--isovalue", "50,auto,60")[1]
expect([row[2] for row in surfaces(j)] == [50, rows[1][2], 60], surfaces(j))
j = draw("in/cells.ome.tif", "--channel", "0,1,2", "--isovalue", "auto,30")[1]
expect([row[2] for row in surfaces(j)] == [rows[0][2], 30, 30], surfaces(j))
# A --volume beside them; one channel alone, and with several isovalues.
j = draw("in/cells.ome.tif", "--channel", "1,2", "--isovalue", "50", "--volume", "in/cells.ome.tif", "--volume-isovalue", "70")[1]
expect([(v["component"], v.get("channel"), v["isovalue"]) for v in j["volumes"]] == [(2, NAMES[2], 50), (0, None, 70)], j["volumes"])
j = draw("in/cells.ome.tif", "--channel", "2", "--isovalue", "50,90")[1]
expect(j["colors"][0] == COLORS[2] != j["colors"][1] and j["volume"]["channel"] == "GFP" and "volumes" not in j, j)

# By their names: as they are written, else in either case; numbers that are no channel's are names, too.
by_name, j, said = draw("in/cells.ome.tif", "--channel", "dapi, 1,gfp")
expect(by_name == wanted and surfaces(j) == rows, surfaces(j))
ome_tiff("in/names.ome.tif", [channel(0, "gfp"), channel(1, "GFP"), channel(2, "488")])
j = draw("in/names.ome.tif", "--channel", "GFP,488,0")[1]
expect([row[:2] for row in surfaces(j)] == [(1, "GFP"), (2, "488"), (0, "gfp")], surfaces(j))
text = run("in/cells.ome.tif", "--info", "--channel", "GFP")[0]
expect("component 2 of 3" in text, text)
done = subprocess.run(["isorender", "-", "stdin.png", "--channel", "GFP", "--json=o.json"], capture_output=True, text=True, stdin=open("in/cells.ome.tif"))
expect(done.returncode == 0 and report("o.json")["volume"]["channel"] == "GFP", done)

# What programs write that know no colours gives distinct ones: none, white for all, or one for all.
for stated in [channel(i) for i in range(3)], [channel(i, None, "FFFFFF") for i in range(3)], [channel(i, "c", "00C800") for i in range(3)], []:
    ome_tiff("in/plain.ome.tif", stated)
    colors = [row[3] for row in surfaces(draw("in/plain.ome.tif", "--channel", "0,1,2")[1])]
    expect(len(set(colors)) == 3 and "FFFFFF" not in colors, stated, colors)

ome_tiff("in/plain.ome.tif", [channel(i) for i in range(3)])
expect("channels" not in run("in/plain.ome.tif", "--info")[0], "channels of which nothing is stated are listed")
for text in run("in/cells.ome.tif", "--info")[0], run("in/cells.ome.tif", "--info", "--channel", "1,2")[0]:
    for i, (name, color) in enumerate(zip(NAMES, COLORS)):
        expect("%d %s, colour %s\n" % (i, name, color) in text, i, text)
expect("\nchannel 2 (GFP)\n  range" in text and text.count("  isovalues ") == 2 and text.count("  format ") == 1, text)

done = subprocess.run(["isorender", "in/cells.ome.tif", "out.png", "--channel", "0,2", "--isovalue", "30,250"], capture_output=True, text=True)
expect(done.returncode == 6 and "in/cells.ome.tif: channel 2 (GFP): no surface at isovalue 250" in done.stderr, done)

for version in 2, 3:
    path = "in/cells%d.ome.zarr" % version
    ome_zarr(path, version)
    if "is not installed" in subprocess.run(["isorender", path, "--info"], capture_output=True, text=True).stderr:
        break
    pixels, j, said = draw(path, "--channel", "0,1,2")
    expect(pixels == wanted and [row[:2] for row in surfaces(j)] == list(enumerate(NAMES)), version, surfaces(j))
P
isorender_refuses 2 "cells.ome.tif: no channel 3, there are 3" in/cells.ome.tif --channel 0,3
isorender_refuses 2 "cells.ome.tif: no channel 4, there are 3" in/cells.ome.tif --channel 4
isorender_refuses 2 "no channel 1, there is 1" scene:sphere:32 --channel 0,1
isorender_refuses 2 "cells.ome.tif: no channel 'x', there are 0 'DAPI', 1 'F-actin <R&D>', 2 'GFP'" in/cells.ome.tif --channel 0,x
isorender_refuses 2 "no channel -1, there are 3 (from 0), without names" in/plain.ome.tif --channel=-1
isorender_refuses 2 "no channel GFP, there is 1 (from 0), without names" scene:sphere:32 --channel GFP
isorender_refuses 2 "2 channels are called 'Gfp': choose by number: 0 'gfp', 1 'GFP'" in/names.ome.tif --channel Gfp
isorender_refuses 2 "between its commas are numbers or names of channels" in/cells.ome.tif --channel 0,,1
isorender_refuses 2 "channel 1 (F-actin <R&D>) is given twice" in/cells.ome.tif --channel 1,0,F-ACTIN\ \<R\&D\>
isorender_refuses 2 "--channel and --component both" in/cells.ome.tif --channel 0,1 --component 0
isorender_refuses 2 "3 isovalues for 2 channels" in/cells.ome.tif --channel 0,1 --isovalue 40,50,60
isorender_refuses 2 "--isovalue: auto stands alone, or is that of one of several --channel" in/cells.ome.tif --isovalue 40,auto
isorender_refuses 2 "3 colours for 2 channels" in/cells.ome.tif --channel 0,1 --color red,blue,green
isorender_refuses 2 "cannot be combined with several channels" in/cells.ome.tif --channel 0,1 --ior 1.5
isorender_refuses 2 "several channels" in/cells.ome.tif --channel 0,1 --chunk-size 32
isorender_refuses 2 "--mesh is for one surface" in/cells.ome.tif --channel 0,1 --mesh m.stl
isorender_refuses 2 "--closed is for one surface" in/cells.ome.tif --channel 0,1 --closed
isorender in/cells.ome.tif --channel 1 --no-image --mesh m.stl --quiet
isorender_refuses 2 "several channels are drawn of one input" in/cells.ome.tif in/plain.ome.tif --channel 0,1 --output '{model}.png'
isorender_refuses 2 "--channel is for an input that is a volume" m.stl --channel 0,1
isorender_refuses 2 "not from a pipe" - --channel 0,1 <in/cells.ome.tif
