"""A stand-in for the Hugging Face Hub on 127.0.0.1: serves a folder, or whatever else a test tells it to answer."""

import hashlib
import json
import threading
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

COMMIT = "0123456789abcdef0123456789abcdef01234567"


class StandIn:
    """What the server answers.

    listing: rows of the listing. answers: part of a path -> (status, body, headers), asked first.
    asked: every path that was asked for with GET.
    """

    def __init__(self, folder: Path) -> None:
        self.folder, self.endpoint = folder, ""
        self.answers: dict[str, tuple[int, bytes, dict]] = {}
        self.asked: list[str] = []
        files = [path for path in sorted(folder.rglob("*")) if path.is_file()]
        self.listing = [row(path.relative_to(folder).as_posix(), path.stat().st_size) for path in files]

    def answer(self, path: str) -> tuple[int, bytes, dict]:
        """Status, body and headers for one path."""
        for part, given in self.answers.items():
            if part in path:
                return given
        if path.startswith("/api/datasets/"):
            return 200, json.dumps(about(self.listing)).encode(), {"Content-Type": "application/json"}
        body = (self.folder / path.split(f"/resolve/{COMMIT}/")[1].split("?")[0]).read_bytes()
        return 200, body, {"ETag": f'"{hashlib.sha1(body).hexdigest()}"', "X-Repo-Commit": COMMIT}

    def fetched(self) -> list[str]:
        """Names of the files that were fetched, in order."""
        return [path.split(f"/resolve/{COMMIT}/")[1] for path in self.asked if "/resolve/" in path]


def about(listing: object, sha: object = COMMIT) -> dict:
    """What the Hub says of a data set, with its listing."""
    return {"id": "BAAI/MOVE", "sha": sha, "siblings": listing, "tags": [], "private": False, "gated": False,
            "disabled": False, "downloads": 0, "likes": 0}


def row(path: object, size: object) -> dict:
    """One file of a listing."""
    return {"rfilename": path, "size": size, "blobId": "0" * 40}


@contextmanager
def serving(folder: Path):
    """Serve a folder as the data set BAAI/MOVE."""
    hub = StandIn(folder)

    class Handler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            if self.command == "GET":
                hub.asked.append(self.path)
            status, body, headers = hub.answer(self.path)
            self.send_response(status)
            for name, value in {"Content-Length": str(len(body)), **headers}.items():
                self.send_header(name, value)
            self.end_headers()
            if self.command == "GET":
                self.wfile.write(body)

        do_HEAD = do_GET

        def log_message(self, *_) -> None:
            pass

    server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.01}, daemon=True)
    thread.start()
    hub.endpoint = f"http://127.0.0.1:{server.server_address[1]}"
    try:
        yield hub
    finally:
        server.shutdown()
        server.server_close()
        thread.join()
