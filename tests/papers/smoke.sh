#!/usr/bin/env bash
# smoke.sh PROGRAMS SOURCE FOLDER: one figure is measured and shown, and kept without its pictures; numbers changed by hand in docs/PAPERS.md,
# and verdicts in docs/claims.md, are found.
set -euo pipefail
programs=$1 source=$2 folder=$3/made
rm -rf "$folder"
mkdir -p "$folder"
python3 "$source/tests/papers/papers.py" "$programs" "$source" "$folder" 2003-figure-4 >"$folder/log"
grep -q '^2003-figure-4 .* yes\.' "$folder/log" || { cat "$folder/log"; exit 1; }
python3 - "$folder" <<'P'
import json
import sys
papers = json.load(open(sys.argv[1] + "/papers.json", encoding="utf-8"))
table, = papers["tables"]
assert table["holds"] == "yes" and len(table["rows"]) == 5, table
assert all("isocompare images" in cell["command"] for row in table["rows"] for cell in row["cells"]), table
page = open(sys.argv[1] + "/index.html", encoding="utf-8").read()
assert page.count("data:image/png;base64,") == len(table["pictures"]) == 5, page[:400]
P
rm "$folder"/cylinder-*.png # a table that is kept, and whose pictures are not
python3 "$source/tests/papers/papers.py" "$programs" "$source" "$folder" 2010-nothing 2>"$folder/log" && exit 1
grep -q '^2010-nothing: no table has a name that begins so; they are 2003-table-2, ' "$folder/log" || { cat "$folder/log"; exit 1; }
python3 "$source/tests/papers/papers.py" "$programs" "$source" "$folder" 2008-figure-9 >/dev/null 2>"$folder/log"
grep -q "^note: 5 pictures of 2003-figure-4 are not in $folder, " "$folder/log" || { cat "$folder/log"; exit 1; }
[ "$(grep -c 'base64\|is not here' "$folder/index.html")" = 7 ] || { echo "pictures of kept tables are not noted"; exit 1; }
check() { python3 "$source/tests/papers/page.py" "$source/docs/papers.json" "$@" --check; }
check "$source/docs/PAPERS.md" "$source/docs/claims.md"
sed '0,/| [0-9]/s/| \([0-9]\)/| 7\1/' "$source/docs/PAPERS.md" >"$folder/changed.md"
if check "$folder/changed.md" "$source/docs/claims.md" >/dev/null; then
    echo "a number that was changed by hand is not found"
    exit 1
fi
sed 's/\[does not hold\](PAPERS/[holds](PAPERS/' "$source/docs/claims.md" >"$folder/claims.md"
if check "$source/docs/PAPERS.md" "$folder/claims.md" >/dev/null; then
    echo "a verdict that was changed by hand in docs/claims.md is not found"
    exit 1
fi
