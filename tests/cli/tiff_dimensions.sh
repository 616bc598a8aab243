# Of a TIFF file with channels, times and positions one volume is read, and the others are named with the option that reads them:
# the order of ImageJ, and the planes and positions of OME. 16-bit floats are read.
python3 - <<'P'
import subprocess
from check import *
from tiff_files import tiff

WIDTH, HEIGHT = 6, 5
SLICES = 4


def plane(channel, slice, time=0, position=0):
    """Its first pixel says which plane it is."""
    return bytes([100 * position + 40 * time + 10 * channel + slice] + [255] * (WIDTH * HEIGHT - 1))


def read(path, component=0, dims=(WIDTH, HEIGHT, SLICES), options=()):
    """The first pixels of the slices, and the notes."""
    done = subprocess.run(["isorender", path, "--info", "--json=o.json", "--component", str(component), *options], capture_output=True,
                          text=True)
    expect(done.returncode == 0, done)
    volume = report("o.json")["volume"]
    expect(volume["dims"] == list(dims), path, volume)
    lows = []
    for z in range(dims[2]):
        done = subprocess.run(["isorender", path, "--info", "--json=o.json", "--component", str(component), "--crop", "0,1,0,1,%d,%d" % (z, z)],
                              capture_output=True, text=True)
        expect(done.returncode == 0, done)
        lows.append(report("o.json")["value_range"][0])
    return lows, " | ".join(volume["notes"])


def is_read(path, component, channel, time=0, position=0, note=""):
    lows, notes = read(path, component)
    wanted = [plane(channel, z, time, position)[0] for z in range(SLICES)]
    expect(lows == wanted, path, component, lows, wanted)
    expect(note in notes, note, notes)


# ImageJ: channels vary fastest, unless it states another order.
for order, planes in ("", [plane(c, z) for z in range(4) for c in range(3)]), ("order=zct\n", [plane(c, z) for c in range(3) for z in range(4)]):
    tiff("in/imagej.tif", (WIDTH, HEIGHT), planes, description="ImageJ=1.53t\nimages=12\nchannels=3\nslices=4\nhyperstack=true\n" + order)
    for channel in range(3):
        is_read("in/imagej.tif", channel, channel, note="using %d of 3 (--component)" % channel)
# Two times of two channels.
tiff("in/times.tif", (WIDTH, HEIGHT), [plane(c, z, t) for t in range(2) for z in range(4) for c in range(2)],
     description="ImageJ=1.53t\nimages=16\nchannels=2\nslices=4\nframes=2\n")
is_read("in/times.tif", 0, 0, note="the first of 2 times is read; the next one is 2 components on (--component)")
is_read("in/times.tif", 3, 1, 1, note="time 1 of 2 is read")
# Times of a single slice are slices, which is said.
tiff("in/planes.tif", (WIDTH, HEIGHT), [plane(0, z) for z in range(4)], description="ImageJ=1.53t\nimages=4\nframes=4\n")
is_read("in/planes.tif", 0, 0, note="4 times of a single slice: they are taken as slices")


def pixels(number, data, channels=1, times=1, order="XYCZT", width=WIDTH):
    return ('<Image ID="Image:%d"><Pixels ID="Pixels:%d" DimensionOrder="%s" Type="uint8" SizeX="%d" SizeY="5" SizeC="%d" SizeZ="4" SizeT="%d" '
            'PhysicalSizeX="1" PhysicalSizeY="1">%s</Pixels></Image>' % (number, number, order, width, channels, times, data))


def ome(*images):
    return '<?xml version="1.0"?><OME UUID="urn:uuid:1">' + "".join(images) + "</OME>"


# Two positions, with and without the places of their planes.
planes = [plane(0, z, 0, p) for p in range(2) for z in range(4)]
for data in ('<TiffData IFD="%d" PlaneCount="4"/>', ""):
    tiff("in/positions.ome.tif", (WIDTH, HEIGHT), planes, description=ome(*(pixels(p, data and data % (4 * p)) for p in range(2))))
    is_read("in/positions.ome.tif", 0, 0, note="the first of 2 positions is read; the next one is 1 component on (--component)")
    is_read("in/positions.ome.tif", 1, 0, 0, 1, note="position 1 of 2 is read")
# Planes in an order that only their own elements tell.
shuffled = [(c, z, t) for z in (2, 0, 3, 1) for t in range(2) for c in (1, 0)]
places = "".join('<TiffData FirstC="%d" FirstZ="%d" FirstT="%d" IFD="%d" PlaneCount="1"><UUID FileName="x.tif">urn:uuid:1</UUID></TiffData>' %
                 (*where, i) for i, where in enumerate(shuffled))
tiff("in/shuffled.ome.tif", (WIDTH, HEIGHT), [plane(*where) for where in shuffled], description=ome(pixels(0, places, 2, 2)))
for channel in range(2):
    for time in range(2):
        is_read("in/shuffled.ome.tif", channel + 2 * time, channel, time)
# An acquisition that ended within the second time, and one whose other position is in another file.
tiff("in/stopped.ome.tif", (WIDTH, HEIGHT), [plane(0, z, t) for t in range(2) for z in range(4)][:6],
     description=ome(pixels(0, '<TiffData IFD="0" PlaneCount="6"/>', 1, 2)))
is_read("in/stopped.ome.tif", 0, 0, note="only 1 of 2 times are complete")
other = '<TiffData IFD="0" PlaneCount="4"><UUID FileName="%s">urn:uuid:2</UUID></TiffData>'
tiff("in/second.ome.tif", (WIDTH, HEIGHT), planes[4:], description=ome(pixels(0, other % "first.ome.tif"), pixels(1, other % "second.ome.tif")))
is_read("in/second.ome.tif", 0, 0, 0, 1, note="only 1 of 2 positions are complete")
# An image of another size, such as a photograph of the slide, is no slice.
tiff("in/label.ome.tif", (WIDTH, HEIGHT), planes[:4] + [((3, 5), bytes(15))],
     description=ome(pixels(0, '<TiffData IFD="0" PlaneCount="4"/>'), pixels(1, '<TiffData IFD="4" PlaneCount="1"/>', width=3)))
is_read("in/label.ome.tif", 0, 0, note="1 images that are no slices")
# 16-bit floats.
values = [float(v) - 7.5 for v in range(WIDTH * HEIGHT)]
tiff("in/half.tif", (WIDTH, HEIGHT), [struct.pack("<30e", *values)] * SLICES, bits=16, kind=3)
lows, notes = read("in/half.tif")
expect(lows == [-7.5] * SLICES and report("o.json")["volume"]["type"] == "float32", lows, report("o.json"))
P
