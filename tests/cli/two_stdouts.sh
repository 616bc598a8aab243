isorender x.vti - --json
