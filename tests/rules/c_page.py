#!/usr/bin/env python3
"""c_page.py ROOT COMPILER: the functions on the page about C compile against the public header, without warnings."""
import re, subprocess, sys
root, compiler = sys.argv[1:3]
blocks = re.findall(r"^```c\n(.*?)^```", open(root + "/docs/c.md").read(), re.M | re.S)
if len(blocks) < 3:
    sys.exit("docs/c.md has %d blocks of C" % len(blocks))
source = "#include <isopoint.h>\n#include <stdio.h>\n" + "".join(blocks)
sys.exit(subprocess.run([compiler, "-std=c17", "-Wall", "-Wextra", "-Werror", "-fsyntax-only", "-I", root + "/src", "-x", "c", "-"],
                        input=source, text=True).returncode)
