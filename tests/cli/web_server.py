"""A web server for tests: web_server.py FOLDER LOG PORT-FILE. It serves the files of FOLDER on the loopback with parts (Range) and
ETags, and writes a line for each reply to LOG: path, status, bytes. FOLDER/.behaviour, read anew for each request, holds words:
busy (each path is refused once by 503), short (a reply breaks off in its middle, once a path), broken (always), parts=no,
wait=SECONDS. Paths below /huge/ are an OME-Zarr image of 1.1 TB in five levels, whose chunks are made when they are asked for."""
import hashlib
import http.server
import json
import os
import struct
import sys
import threading
import time

folder, log_path, port_path = sys.argv[1:4]
met, lock = set(), threading.Lock()
SIDE, CHUNK, LEVELS = 10240, 64, 8  # of the huge image: voxels along each axis, and those of a chunk


def huge(path):
    if path == ".zattrs":
        scales = [{"path": str(i), "coordinateTransformations": [{"type": "scale", "scale": [2 ** i] * 3}]} for i in range(LEVELS)]
        axes = [{"name": a, "type": "space", "unit": "micrometer"} for a in "zyx"]
        return json.dumps({"multiscales": [{"version": "0.4", "axes": axes, "datasets": scales}]}).encode()
    level, name = path.split("/", 1) if "/" in path else ("", "")
    if not level.isdigit() or int(level) >= LEVELS:
        return None
    side = SIDE >> int(level)
    if name == ".zarray":
        return json.dumps({"zarr_format": 2, "shape": [side] * 3, "chunks": [CHUNK] * 3, "dtype": "|u1", "compressor": None,
                           "fill_value": 0, "order": "C", "filters": None, "dimension_separator": "/"}).encode()
    at = name.split("/")
    if len(at) != 3 or not all(a.isdigit() for a in at):
        return None
    first, middle = [int(a) * CHUNK for a in at], side / 2
    planes = []
    for z in range(first[0], first[0] + CHUNK):
        for y in range(first[1], first[1] + CHUNK):
            far = (z - middle) ** 2 + (y - middle) ** 2
            planes.append(bytes(max(0, min(255, int(255 - 250 * ((x - middle) ** 2 + far) / (middle * middle)))) for x in range(first[2], first[2] + CHUNK)))
    return b"".join(planes)


class Handler(http.server.BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"

    def log_message(self, *_):
        pass

    def reply(self, status, body=b"", mark=None, promised=None):
        with lock, open(log_path, "a") as file:
            file.write("%s %d %d\n" % (self.path, status, len(body)))
        self.send_response(status)
        if mark:
            self.send_header("ETag", mark)
        if status != 304:
            self.send_header("Content-Length", str(promised or len(body)))
        self.end_headers()
        self.wfile.write(body)
        if promised:
            self.close_connection = True

    def do_GET(self):
        with open(os.path.join(folder, ".behaviour")) as file:
            words = file.read().split()
        for word in words:
            if word.startswith("wait="):
                time.sleep(float(word[5:]))
        path = os.path.join(folder, self.path.split("?")[0].lstrip("/"))
        with lock:
            again = self.path in met
            met.add(self.path)
        if "busy" in words and not again:
            return self.reply(503)
        if self.path.startswith("/huge/"):
            body = huge(self.path[6:])
        elif os.path.isfile(path):
            with open(path, "rb") as file:
                body = file.read()
        else:
            body = None
        if body is None:
            return self.reply(404, b"<html>no such page</html>")
        mark, status, wanted = '"%s"' % hashlib.md5(body).hexdigest(), 200, self.headers.get("Range")
        if self.headers.get("If-None-Match") == mark:
            return self.reply(304, mark=mark)
        if wanted and "parts=no" not in words:
            first, last = wanted.split("=")[1].split("-")
            body, status = (body[int(first):int(last) + 1] if first else body[-int(last):]), 206
        if body and ("broken" in words or ("short" in words and not again)):
            return self.reply(status, body[:len(body) // 2], mark, len(body))
        return self.reply(status, body, mark)

    do_HEAD = do_POST = do_PUT = lambda self: self.reply(405)


server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler)
server.daemon_threads = True
with open(port_path + ".new", "w") as file:
    file.write(str(server.server_address[1]))
os.rename(port_path + ".new", port_path)
server.serve_forever()
