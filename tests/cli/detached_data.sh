# A header whose data file is missing, short, a pipe, a socket, a device or a folder: refused at once, in one line that
# names both files and the reason.
formats="nhdr mhd hdr"
python3 - <<'END'
import socket
from check import nifti_header
open("in/a.nhdr", "w").write("NRRD0004\ntype: uchar\ndimension: 3\nsizes: 8 8 8\nencoding: raw\ndata file: data.img\n")
open("in/a.mhd", "w").write("NDims = 3\nDimSize = 8 8 8\nElementType = MET_UCHAR\nElementDataFile = data.img\n")
open("in/data.hdr", "wb").write(nifti_header((8, 8, 8), 2, 8) + bytes(4))
END
try() { # try REASON: every format's line must hold it
    for format in $formats; do
        header=in/a.$format
        [ $format != hdr ] || header=in/data.hdr
        status=0
        timeout 20 isorender $header out.png >said 2>&1 || status=$?
        if [ $status -ne 3 ] || [ "$(grep -c '' said)" -ne 1 ] || ! grep -q "^isorender: $header: in/data.img: .*$1" said; then
            echo "$format, $1: status $status: $(cat said)"
            exit 1
        fi
    done
    rm -rf in/data.img said
}
head -c 511 /dev/zero >in/data.img
try "truncated: 511 of 512 bytes"
mkfifo in/data.img
try "not a regular file"
python3 -c 'import socket; socket.socket(socket.AF_UNIX).bind("in/data.img")'
try "not a regular file"
ln -s /dev/zero in/data.img
try "not a regular file"
mkdir in/data.img
try "not a regular file"
formats="nhdr mhd" # the third finds its data file by looking for it
try "No such file or directory"
