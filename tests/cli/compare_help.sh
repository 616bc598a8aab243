[ "$(isocompare --help | wc -l)" -le 25 ]
isocompare --help report | grep -q -- '--output DIR'
isocompare --help images | grep -q -- '--fail-under METRIC=VALUE'
isocompare --help=markdown | grep -q '^| `--fail-under METRIC=VALUE` |'
isocompare --help=man | grep -q '^.TH ISOCOMPARE 1'
isocompare --help=bash | bash -n
isocompare --version | grep -q '^isocompare [0-9]'
