# exit: 3
# stderr: isorender: in/a.nii: values of unknown NIfTI type 255
# The NIfTI types that have no size: libnifti2 knows some of them by name, but cannot convert them.
python3 - <<'P'
from check import *
for kind in (0, 1, 255):
    open("in/%d.nii" % kind, "wb").write(nifti_header((4, 4, 4), kind, 8)[:344] + b"n+1\0" + bytes(4 + 64))
P
for kind in 0 1; do
    isorender in/$kind.nii --info >out.txt 2>said || code=$?
    [ $code -eq 3 ] && [ "$(cat said)" = "isorender: in/$kind.nii: values of unknown NIfTI type $kind" ] || { cat said; exit 1; }
done
rm out.txt said
mv in/255.nii in/a.nii
isorender in/a.nii --info
