#!/usr/bin/env python3
"""`twinchute serve` as a page, a stranger and a broken client see it. Usage: serve_test.py PROGRAM SOURCE_DIR"""

import gzip
import http.client
import json
import os
import random
import re
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest

PROGRAM, SOURCE = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
SCENE = os.path.join(SOURCE, "data/scenes/c9-inflation.toml")


def content(path):
    with open(path, "rb") as file:
        return file.read()


TEXT = content(SCENE).decode()
# A full run of some tenths of a second, and one that lasts until somebody ends it.
QUICK = ["full.mesh.gore_columns=1", "full.mesh.gore_rows=4", "full.mesh.line_elements=4", "stop.time=0.25"]
ENDLESS = ["release.height=6000", "stop.time=1000"]
# [s] within which the server ends beside whatever else the machine does; what it ends would run for minutes.
PROMPTLY = 10.0


class Server:
    """A server of its own scene in a directory of its own."""

    def __init__(self, *more, scene="drop.toml"):
        self.place = tempfile.TemporaryDirectory()
        self.directory = os.path.realpath(self.place.name)
        self.scene = os.path.join(self.directory, "drop.toml")
        with open(self.scene, "w", encoding="utf-8") as file:
            file.write(TEXT)
        words = [PROGRAM, "serve"] + ([scene] if scene else []) + list(more)
        self.scratch = tempfile.TemporaryDirectory()  # its own: other tests put folders of the same names in the common one
        self.process = subprocess.Popen(words, cwd=self.directory, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                        env={**os.environ, "TMPDIR": self.scratch.name})
        self.address = self.process.stdout.readline().strip()
        found = re.fullmatch(r"http://127\.0\.0\.1:(\d+)/\?token=([0-9a-f]{32})", self.address)
        if not found:
            raise AssertionError(f"no address: {self.address!r} {self.process.stderr.read()}")
        self.port, self.token = int(found[1]), found[2]

    def ask(self, method, path, body=None, headers=None, token=True):
        """Status, headers and bytes of an answer; of a body that is no bytes, its JSON is sent."""
        sent = {"X-Twinchute-Token": self.token} if token else {}
        if body is not None:
            sent["Content-Type"] = "application/json"
            body = body if isinstance(body, bytes) else json.dumps(body).encode()
        sent.update(headers or {})
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=30)
        try:
            connection.putrequest(method, path, skip_host="Host" in sent, skip_accept_encoding=True)
            if body is not None and not {"Content-Length", "Transfer-Encoding"} & set(sent):
                sent["Content-Length"] = str(len(body))
            for name, value in sent.items():
                if value is not None:
                    connection.putheader(name, value)
            connection.endheaders(body)
            answer = connection.getresponse()
            return answer.status, answer.headers, answer.read()
        finally:
            connection.close()

    def get(self, path):
        status, _, data = self.ask("GET", path)
        assert status == 200, (status, data)
        return json.loads(data)

    def post(self, path, body):
        status, _, data = self.ask("POST", path, body)
        return status, json.loads(data)

    def start(self, kind, overrides):
        status, answer = self.post("/api/" + kind, {"text": TEXT, "set": overrides})
        assert status == 202, (status, answer)
        return answer["id"]

    def ended(self, run):
        while True:
            state = self.get(f"/api/runs/{run}")
            if state["state"] != "running":
                return state
            time.sleep(0.05)

    def raw(self, data, wait=10.0):
        """What comes back on a connection of its own; nothing where the server closes it."""
        got = b""
        with socket.create_connection(("127.0.0.1", self.port), timeout=wait) as connection:
            try:
                connection.sendall(data)
                connection.shutdown(socket.SHUT_WR)
                while chunk := connection.recv(1 << 16):
                    got += chunk
            except OSError:
                pass  # closed while more was to come
        return got

    def files(self):
        """Bytes of everything in its directory, by name."""
        found = {}
        for folder, _, names in os.walk(self.directory):
            for name in names:
                path = os.path.join(folder, name)
                found[os.path.relpath(path, self.directory)] = None if os.path.islink(path) else content(path)
        return found

    def end(self):
        """Ctrl-C: the seconds until the end, the exit code and what was printed after the address."""
        begin = time.monotonic()
        self.process.send_signal(signal.SIGINT)
        out, err = self.process.communicate(timeout=30)
        self.err = err
        return time.monotonic() - begin, self.process.returncode, out

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.process.poll() is None:
            self.process.kill()
            self.process.communicate()
        self.scratch.cleanup()
        self.place.cleanup()


def program(*words, cwd=None):
    return subprocess.run([PROGRAM, *words], capture_output=True, text=True, check=False, cwd=cwd, timeout=120)


def message_of(data):
    return json.loads(data)["error"]["message"]


class Shared(unittest.TestCase):
    """Tests that leave their server as it was."""

    @classmethod
    def setUpClass(cls):
        cls.server = Server()

    @classmethod
    def tearDownClass(cls):
        cls.server.__exit__()

    def refused(self, status, method, path, **more):
        got, headers, data = self.server.ask(method, path, **more)
        self.assertEqual(got, status, data)
        self.assertNotIn(b"root:", data)
        return headers, data


class Access(Shared):
    def test_page_needs_the_token(self):
        server = self.server
        status, headers, page = server.ask("GET", f"/?token={server.token}", token=False)
        self.assertEqual(status, 200)
        self.assertTrue(page.startswith(b"<!DOCTYPE html>"), page[:100])
        self.assertEqual(headers["Content-Type"], "text/html; charset=utf-8")
        for path in ("/", "/?token=", "/?token=" + "0" * 32, f"/?token={server.token}0", f"/?token={server.token[:-1]}",
                     f"/?token={server.token}&token=x"):
            headers, data = self.refused(403, "GET", path, token=False)
            self.assertEqual(headers["Content-Type"], "text/plain")

    def test_answers_forbid_what_a_page_does_not_need(self):
        for path in (f"/?token={self.server.token}", "/api/scene", "/nothing"):
            headers = self.server.ask("GET", path)[1]
            policy = headers["Content-Security-Policy"]
            for part in ("default-src 'none'", "connect-src 'self'", "base-uri 'none'", "form-action 'none'", "frame-ancestors 'none'"):
                self.assertIn(part, policy)
            self.assertEqual(headers["Cache-Control"], "no-store")
            self.assertEqual(headers["X-Frame-Options"], "DENY")
            self.assertEqual(headers["Referrer-Policy"], "no-referrer")
            self.assertEqual(headers["X-Content-Type-Options"], "nosniff")
            self.assertNotIn("Access-Control-Allow-Origin", headers)

    def test_every_call_needs_the_token(self):
        calls = [("GET", path) for path in ("/api/keys", "/api/scene", "/api/runs", "/api/runs/1", "/api/runs/1/history",
                                            "/api/runs/1/summary", "/api/runs/1/report", "/api/runs/1/frames")]
        calls += [("DELETE", "/api/runs/1")] + [("POST", f"/api/{name}") for name in ("rom", "full", "compare", "save")]
        for method, path in calls:
            body = {"text": TEXT, "name": "x.toml"} if method == "POST" else None
            for wrong in (None, "", "0" * 32, self.server.token.upper() + "0"):
                self.refused(403, method, path, body=body, headers={"X-Twinchute-Token": wrong} if wrong is not None else {}, token=False)
            if "summary" not in path and "report" not in path:  # those are opened by address
                self.refused(403, method, f"{path}?token={self.server.token}", body=body, token=False)
        self.assertEqual(self.server.get("/api/runs"), [])
        self.assertEqual(list(self.server.files()), ["drop.toml"])

    def test_host_and_origin_are_this_server(self):
        port = self.server.port
        for host in (f"127.0.0.1:{port}", f"localhost:{port}"):
            for origin in (None, f"http://{host}"):
                status = self.server.ask("GET", "/api/scene", headers={"Host": host, "Origin": origin})[0]
                self.assertEqual(status, 200, (host, origin))
        for host in ("evil.example", f"evil.example:{port}", "127.0.0.1", f"127.0.0.1:{port + 1}", f"127.0.0.1:{port}.evil.example", ""):
            self.refused(403, "GET", "/api/scene", headers={"Host": host})
        for origin in ("http://evil.example", "null", f"https://127.0.0.1:{port}", f"http://127.0.0.1:{port + 1}",
                       f"http://localhost:{port}", f"http://127.0.0.1:{port}/"):
            self.refused(403, "GET", "/api/scene", headers={"Origin": origin})
        for site, status in (("same-origin", 200), ("none", 200), ("cross-site", 403), ("same-site", 403), ("x", 403)):
            self.assertEqual(self.server.ask("GET", "/api/scene", headers={"Sec-Fetch-Site": site})[0], status, site)
        no_host = self.server.raw(f"GET /api/scene HTTP/1.1\r\nX-Twinchute-Token: {self.server.token}\r\n\r\n".encode())
        self.assertTrue(no_host.startswith(b"HTTP/1.1 403"), no_host[:80])
        two = self.server.raw(f"GET /api/scene HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nHost: evil\r\n"
                              f"X-Twinchute-Token: {self.server.token}\r\n\r\n".encode())
        self.assertTrue(two.startswith(b"HTTP/1.1 403"), two[:80])

    def test_methods(self):
        for method in ("PUT", "PATCH", "HEAD", "OPTIONS", "TRACE", "DELETE"):
            self.assertEqual(self.server.ask(method, "/api/scene")[0], 405, method)
        headers, _ = self.refused(405, "GET", "/api/rom")
        self.assertEqual(headers["Allow"], "POST")
        headers, _ = self.refused(405, "PUT", "/api/runs/1")
        self.assertEqual(headers["Allow"], "GET, DELETE")
        self.assertIn(self.server.ask("BREW", "/api/scene")[0], (400, 405))

    def test_bodies(self):
        body = json.dumps({"text": TEXT}).encode()
        for kind in ("text/plain", "application/x-www-form-urlencoded", "multipart/form-data; boundary=x", "application/jsonx", None):
            self.refused(415, "POST", "/api/rom", body=body, headers={"Content-Type": kind})
        status = self.server.ask("POST", "/api/rom", body=body, headers={"Content-Type": "application/json; charset=utf-8"})[0]
        self.assertEqual(status, 200)
        self.refused(415, "POST", "/api/rom", body=gzip.compress(body), headers={"Content-Encoding": "gzip"})
        self.refused(411, "POST", "/api/rom", body=b"5\r\nhello\r\n0\r\n\r\n", headers={"Transfer-Encoding": "chunked"})
        self.refused(411, "POST", "/api/rom", body=body, headers={"Transfer-Encoding": "chunked", "Content-Length": str(len(body))})
        self.refused(411, "POST", "/api/rom", headers={"Content-Type": "application/json"})
        self.refused(400, "POST", "/api/rom", body=body, headers={"Content-Length": "-1"})
        self.refused(400, "GET", "/api/scene", body=b"x")

    def test_largest_body(self):
        limit = 4 << 20
        frame = len(json.dumps({"text": ""}))
        status, _, data = self.server.ask("POST", "/api/rom", body={"text": "#" * (limit - frame)})
        self.assertEqual(status, 422, data[:200])  # read, and no scene
        self.refused(413, "POST", "/api/rom", body={"text": "#" * (limit - frame + 1)})
        self.refused(413, "POST", "/api/rom", body=b"", headers={"Content-Length": "99999999999999999999999"})

    def test_broken_json(self):
        for body in (b"", b"{", b"[]", b"\xff\xfe", b'{"text": 3}', b'{"txt": ""}', b'{}', b'{"text": "", "set": 1}',
                     b'{"text": "", "set": [1]}', b"[" * 100000, b'{"text": ' + b"[" * 100000, b'{"text": "\\ud800"}'):
            self.refused(400, "POST", "/api/rom", body=body)
        for count in (10, 100000):
            _, data = self.refused(400, "POST", "/api/rom", body=b'{"set": ' + b"[" * count + b"]" * count + b"}")
            self.assertIn("deeper than", message_of(data))
        self.refused(400, "POST", "/api/save", body={"name": "x.toml"})
        self.refused(400, "POST", "/api/save", body={"name": "x.toml", "text": "", "overwrite": "yes"})

    def test_no_path_is_a_file(self):
        deep = "/.." * 12 + "/etc/passwd"
        coded = deep.replace("..", "%2e%2e")
        for path in (deep, coded, "/etc/passwd", "//etc/passwd", "/drop.toml", "/page.html", "/api", "/api/", "/api/scene/", "/api/scene" + deep,
                     "/api/runs/1/", "/api/runs/1/..", "/api/runs/" + coded, "/api/runs/1" + deep, "/api/runs/1/history" + coded,
                     "/api/runs/..%2f..%2fetc%2fpasswd/x", "/" + "a" * 8000, "/api/keys%00.html"):
            self.refused(404, "GET", path)
        for run in ("..", "%2e%2e%2fetc", "-1", "99", "x" * 100, "1%00"):
            for part in ("", "/history", "/summary", "/report", "/frames"):
                self.refused(404, "GET", f"/api/runs/{run}{part}")
            self.refused(404, "DELETE", f"/api/runs/{run}")
        self.assertIn(b" 414 ", self.server.raw(b"GET /" + b"a" * 9000 + b" HTTP/1.1\r\n\r\n")[:40])

    def test_range_and_compression_are_left_out(self):
        whole = self.server.ask("GET", "/api/scene")[2]
        for value in ("bytes=0-3", "bytes=0-0,2-3", "bytes=" + "0-0," * 1500 + "0-0", "bytes=5000000-"):
            status, headers, data = self.server.ask("GET", "/api/scene", headers={"Range": value, "Accept-Encoding": "gzip, br"})
            self.assertEqual((status, data), (200, whole))
            self.assertNotIn("Content-Encoding", headers)

    def test_what_follows_a_refused_body_is_no_request(self):
        hidden = f"GET /api/scene HTTP/1.1\r\nHost: 127.0.0.1:{self.server.port}\r\nX-Twinchute-Token: {self.server.token}\r\n\r\n"
        got = self.server.raw(f"POST /api/rom HTTP/1.1\r\nHost: 127.0.0.1:{self.server.port}\r\nX-Twinchute-Token: {self.server.token}\r\n"
                              f"Content-Type: text/plain\r\nContent-Length: {len(hidden)}\r\n\r\n{hidden}".encode())
        self.assertEqual(got.count(b"HTTP/1.1"), 1, got[:400])
        self.assertIn(b"HTTP/1.1 415", got)


class Scenes(Shared):
    def test_scene_and_keys(self):
        self.assertEqual(self.server.get("/api/scene"), {"file": "drop.toml", "text": TEXT})
        self.assertEqual(self.server.ask("GET", "/api/keys")[2].decode(), program("list", "keys", "--json").stdout)

    def test_rom_is_that_of_the_command_line(self):
        for overrides in ([], ["payload.mass='120 kg'", "release.speed=25"]):
            status, answer = self.server.post("/api/rom", {"text": TEXT, "set": overrides})
            self.assertEqual(status, 200, answer)
            words = [word for override in overrides for word in ("--set", override)]
            with tempfile.TemporaryDirectory() as out:
                by_hand = json.loads(program("rom", SCENE, "--json", "--out", out, *words).stdout)
                with open(os.path.join(out, "history.csv"), encoding="utf-8") as file:
                    names, units, *lines = [line.rstrip("\n").split(",") for line in file]
            for part in ("metrics", "status", "inputs", "energy", "warnings", "left_out"):
                self.assertEqual(answer["summary"].get(part), by_hand.get(part), part)
            # To the last bit: the same numbers, written shortest.
            self.assertEqual(list(answer["history"]), names)
            self.assertEqual([answer["units"][name] or "1" for name in names], units)
            for column, name in enumerate(names):
                written = [float(line[column]) if line[column] else None for line in lines]
                self.assertEqual(answer["history"][name], written, name)
            self.assertEqual(answer["cases"], [])

    def test_size_is_that_of_the_command_line(self):
        scene = os.path.join(os.path.dirname(SCENE), "sizing", "cargo-drop.toml")
        text = content(scene).decode()
        status, answer = self.server.post("/api/size", {"text": text})
        self.assertEqual(status, 200, answer)
        by_hand = json.loads(program("size", scene, "--json").stdout)
        texts = [one.pop("scene_text") for one in answer["candidates"]]
        self.assertEqual(answer["candidates"], by_hand["candidates"])
        for one, sized in zip(by_hand["candidates"], texts):  # each text is the scene of its candidate
            status, run = self.server.post("/api/rom", {"text": sized})
            self.assertEqual(status, 200, run)
            rate = run["summary"]["metrics"]["descent_rate_m_s"]
            rate = rate["value"] if isinstance(rate, dict) else rate
            self.assertAlmostEqual(rate / one["metrics"]["descent_rate_m_s"], 1.0, places=9)
        status, answer = self.server.post("/api/size", {"text": TEXT})
        self.assertEqual(status, 422)
        self.assertIn("there is no [size]", answer["error"]["message"])

    def test_series(self):
        series = TEXT + '\n[[case]]\nname = "slow"\nset = { "release.speed" = "20 m/s" }\n[[case]]\nname = "fast"\nset = { "release.speed" = "30 m/s" }\n'
        speed = {}
        for name in ("", "slow", "fast"):
            status, answer = self.server.post("/api/rom", {"text": series, **({"case": name} if name else {})})
            self.assertEqual((status, answer.get("cases")), (200, ["slow", "fast"]), answer)
            speed[name] = answer["summary"]["inputs"]["release.speed"]["value"]
        self.assertEqual(speed, {"": 20.0, "slow": 20.0, "fast": 30.0})
        self.refused(400, "POST", "/api/rom", body={"text": series, "case": "fats"})

    def test_errors_are_those_of_the_command_line(self):
        for text, overrides in ((TEXT + "\nnonsense = 1\n", []), (TEXT.replace("152.4 kg", "152.4 m"), []), ("[", []), (TEXT, ["payload.mas=3"]),
                                ("", []), (TEXT, ["payload.mass"]), (TEXT.replace('"usaf-c9"', '"usaf-c8"'), [])):
            with open(os.path.join(self.server.directory, "wrong.toml"), "w", encoding="utf-8") as file:
                file.write(text)
            said = program("rom", "wrong.toml", *[word for one in overrides for word in ("--set", one)], cwd=self.server.directory)
            os.remove(file.name)
            self.assertEqual(said.returncode, 2)
            status, answer = self.server.post("/api/rom", {"text": text, "set": overrides})
            self.assertEqual(status, 422, answer)
            error = answer["error"]
            self.assertEqual(error["message"] + "\n", said.stderr.removeprefix("twinchute: ").replace("wrong.toml", "drop.toml"))
            if "line" in error:
                self.assertTrue(error["message"].startswith(f"{error['file']}:{error['line']}:{error['column']}: "), error)
        status, answer = self.server.post("/api/rom", {"text": TEXT + "\nnonsense = 1\n"})
        self.assertEqual((answer["error"]["line"], answer["error"]["file"]), (TEXT.count("\n") + 2, "drop.toml"))
        self.assertIn("nonsense", answer["error"]["key"])

    def test_files_outside_are_not_read(self):
        with tempfile.TemporaryDirectory() as elsewhere:
            secret = os.path.join(elsewhere, "secret.toml")
            with open(secret, "w", encoding="utf-8") as file:
                file.write(TEXT)
            link = os.path.join(self.server.directory, "link.toml")
            os.symlink(secret, link)
            inner = os.path.join(self.server.directory, "inner.toml")
            with open(inner, "w", encoding="utf-8") as file:
                file.write(f'base = "{secret}"\n')
            try:
                beside = os.path.relpath(secret, self.server.directory)
                for base in ("/etc/passwd", secret, beside, "../" + beside, "sub/../" + beside, "link.toml", "inner.toml", "/no/such/file", ".."):
                    status, answer = self.server.post("/api/rom", {"text": f'base = "{base}"\n'})
                    self.assertEqual(status, 422, base)
                    self.assertIn("base: leaves the directory of the scene", answer["error"]["message"], base)
                    self.assertNotIn("root:", answer["error"]["message"])
                for key in ("environment.wind.table", "environment.atmosphere.table", "parachute.mesh", "parachute.design", "parachute.fabric"):
                    for name in ("/etc/passwd", "../../../../../../../etc/passwd", secret, beside):
                        status, answer = self.server.post("/api/rom", {"text": TEXT, "set": [f'{key}="{name}"']})
                        self.assertEqual(status, 422, (key, name, answer))
                        self.assertNotIn("root:", answer["error"]["message"])
                # The command line may: the file is the user's own.
                with open(os.path.join(self.server.directory, "by_hand.toml"), "w", encoding="utf-8") as file:
                    file.write(f'base = "{secret}"\n')
                self.assertEqual(program("rom", file.name).returncode, 0)
                os.remove(file.name)
            finally:
                os.remove(link)
                os.remove(inner)

    def test_files_beside_the_scene_are_read(self):
        with Server() as server:
            self.assertEqual(server.post("/api/save", {"name": "other.toml", "text": TEXT})[0], 200)
            status, answer = server.post("/api/rom", {"text": 'base = "other.toml"\n', "set": ["payload.mass=100"]})
        self.assertEqual(status, 200, answer)
        self.assertEqual(answer["summary"]["inputs"]["payload.mass"]["value"], 100.0)
        status, answer = self.server.post("/api/rom", {"text": 'base = "c9-reefed.toml"\n'})  # of the data
        self.assertEqual(status, 200, answer)


class Saving(unittest.TestCase):
    def save(self, server, name, text="schema = 1\n", **more):
        status, answer = server.post("/api/save", {"name": name, "text": text, **more})
        return status, answer.get("error", {}).get("message", "")

    def test_names_and_files_of_others(self):
        with Server() as server:
            other = os.path.join(server.directory, "mine.toml")
            with open(other, "w", encoding="utf-8") as file:
                file.write("# of somebody\n")
            os.symlink("/etc/hostname", os.path.join(server.directory, "link.toml"))
            os.mkdir(os.path.join(server.directory, "folder.toml"))
            before = server.files()
            for name in ("", ".toml", "x", "x.txt", "../x.toml", "/tmp/x.toml", "a/b.toml", "..toml", ".x.toml", "x\0.toml", "x y.toml",
                         "x\n.toml", "-x.toml", "x..toml", "ä.toml", "a" * 90 + ".toml", "%2e%2e%2fx.toml", "..\\x.toml"):
                status, said = self.save(server, name)
                self.assertEqual(status, 422, name)
                self.assertIn("is no name for a scene", said)
            for name in ("mine.toml", "link.toml", "folder.toml"):
                for more in ({}, {"overwrite": True}):
                    self.assertEqual(self.save(server, name, **more)[0], 409, name)
            self.assertEqual(self.save(server, "drop.toml")[0], 409)
            self.assertEqual(server.files(), before)

            # A new one, again, and the opened one when that is said.
            for text in ("# first\n", "# second\n"):
                self.assertEqual(self.save(server, "new.toml", text)[0], 200)
                self.assertEqual(server.files(), {**before, "new.toml": text.encode()})
            self.assertEqual(self.save(server, "drop.toml", "# third\n", overwrite=True)[0], 200)
            self.assertEqual(server.files(), {**before, "new.toml": b"# second\n", "drop.toml": b"# third\n"})
            self.assertEqual(server.get("/api/scene")["text"], "# third\n")

    def test_directory(self):
        with tempfile.TemporaryDirectory() as other, Server("--dir", other) as server:
            self.assertEqual(self.save(server, "drop.toml")[0], 200)  # not the opened one: that lies elsewhere
            self.assertEqual(os.listdir(other), ["drop.toml"])
            self.assertEqual(server.files(), {"drop.toml": TEXT.encode()})


class RunsOfThePage(unittest.TestCase):
    def test_full_run_to_its_end(self):
        with Server() as server:
            run = server.start("full", QUICK)
            self.assertEqual(server.get("/api/runs")[0]["id"], run)
            state = server.ended(run)
            self.assertEqual((state["state"], state["kind"], state["share"], state["error"], state["gap"]), ("done", "full", 1.0, None, None))
            by_hand = json.loads(program("full", SCENE, "--json", "--out", os.path.join(server.directory, "by_hand"),
                                         *[word for one in QUICK for word in ("--set", one)]).stdout)
            # The full model gives the same bits with any number of threads.
            self.assertEqual(state["summary"]["metrics"], by_hand["metrics"])
            history = server.get(f"/api/runs/{run}/history")["history"]
            with open(os.path.join(server.directory, "by_hand/history.csv"), encoding="utf-8") as file:
                names, _, *lines = [line.rstrip("\n").split(",") for line in file]
            self.assertEqual(history["force"], [float(line[names.index("force")]) for line in lines])
            # The rows are those of the history.
            self.assertEqual(state["rows"], {name: history[name] for name in ("time", "force", "speed")})
            late = server.get(f"/api/runs/{run}?from=3")["rows"]
            self.assertEqual(late, {name: history[name][3:] for name in late})
            _, headers, table = server.ask("GET", f"/api/runs/{run}/history.csv?token={server.token}", token=False)
            self.assertEqual(headers["Content-Disposition"], 'attachment; filename="history.csv"')
            self.assertEqual(table, content(os.path.join(server.directory, "by_hand/history.csv")))
            self.assertEqual(server.ask("GET", f"/api/runs/{run}/history.csv?model=rom")[0], 404)
            self.assertEqual(server.ask("GET", f"/api/runs/{run}/history.csv?model=xyz")[0], 400)
            with open(os.path.join(server.directory, "by_hand/frames.bin"), "rb") as file:
                self.assertEqual(server.ask("GET", f"/api/runs/{run}/frames")[2], file.read())
            status, headers, report = server.ask("GET", f"/api/runs/{run}/report?token={server.token}", token=False)
            self.assertEqual((status, headers["Content-Type"]), (200, "text/html; charset=utf-8"))
            self.assertIn(b"C-9 inflation", report)
            _, headers, summary = server.ask("GET", f"/api/runs/{run}/summary")
            self.assertEqual(headers["Content-Disposition"], 'attachment; filename="summary.json"')
            self.assertEqual(json.loads(summary), state["summary"])
            seconds, code, out = server.end()
            self.assertEqual((code, out), (0, ""), server.err)

    def test_channels_that_end_before_the_run(self):
        """The rest of the fall by the reduced-order model has no canopy: no numbers, neither in JSON nor in CSV."""
        overrides = QUICK[:-1] + ["stop.then=rom"]
        with Server() as server:
            state = server.ended(server.start("full", overrides))
            self.assertEqual(state["state"], "done", state["error"])
            out = os.path.join(server.directory, "by_hand")
            program("full", SCENE, "--quiet", "--out", out, *[word for one in overrides for word in ("--set", one)])
            names, _, *lines = [line.split(",") for line in content(os.path.join(out, "history.csv")).decode().splitlines()]
            history = server.get(f"/api/runs/{state['id']}/history")["history"]
            for column, name in enumerate(names):
                self.assertEqual(history[name], [float(line[column]) if line[column] else None for line in lines], name)
            self.assertIn(None, history["projected_area"])
            self.assertNotIn(None, history["speed"])

    def test_comparison(self):
        with Server() as server:
            state = server.ended(server.start("compare", QUICK))
            self.assertEqual(state["state"], "done", state["error"])
            out = os.path.join(server.directory, "by_hand")
            program("compare", SCENE, "--quiet", "--out", out, *[word for one in QUICK for word in ("--set", one)])
            with open(os.path.join(out, "gap.json"), encoding="utf-8") as file:
                self.assertEqual(state["gap"]["metrics"], json.load(file)["metrics"])
            self.assertEqual((state["summary"]["fidelity"], state["rom_summary"]["fidelity"]), ("full", "rom"))
            self.assertIn("history", server.get(f"/api/runs/{state['id']}/history?model=rom"))
            self.assertEqual(server.ask("GET", f"/api/runs/{state['id']}/history.csv?model=rom")[2], content(os.path.join(out, "rom", "history.csv")))
            self.assertEqual(server.ask("GET", f"/api/runs/{state['id']}/report?token={server.token}", token=False)[0], 200)

    def test_two_at_a_time_and_cancel(self):
        with Server() as server:
            first, second = server.start("full", ENDLESS), server.start("compare", ENDLESS)
            status, answer = server.post("/api/full", {"text": TEXT})
            self.assertEqual(status, 429, answer)
            self.assertEqual(server.ask("GET", f"/api/runs/{first}/history")[0], 409)
            self.assertEqual(server.ask("DELETE", f"/api/runs/{first}")[0], 200)
            state = server.ended(first)
            self.assertEqual(state["state"], "cancelled")
            self.assertEqual(state["summary"]["status"]["code"], "interrupted")
            third = server.start("full", QUICK)
            self.assertEqual(server.ended(third)["state"], "done")
            self.assertEqual([run["state"] for run in server.get("/api/runs")], ["cancelled", "running", "done"])
            self.assertEqual(server.ask("DELETE", f"/api/runs/{second}")[0], 200)
            self.assertEqual(server.ended(second)["state"], "cancelled")
            for _ in range(7):  # those that ended first are forgotten
                server.ended(server.start("full", QUICK))
            kept = [run["id"] for run in server.get("/api/runs")]
            self.assertEqual(len(kept), 8)
            self.assertNotIn(first, kept)

    def test_rows_come_while_it_runs(self):
        with Server() as server:
            run = server.start("full", ENDLESS)
            seen = []
            while len(seen) < 3:
                state = server.get(f"/api/runs/{run}")
                self.assertEqual(state["state"], "running", state["error"])
                rows = state["rows"]
                self.assertEqual(len({len(rows[name]) for name in rows}), 1)
                if rows["time"] and (not seen or len(rows["time"]) > len(seen[-1]["time"])):
                    seen.append(rows)
                time.sleep(0.02)
            frames = b""
            while not frames:
                self.assertEqual(server.get(f"/api/runs/{run}")["state"], "running")
                frames = server.ask("GET", f"/api/runs/{run}/frames")[2]
                time.sleep(0.02)
            server.ask("DELETE", f"/api/runs/{run}")
            server.ended(run)
            whole = server.ask("GET", f"/api/runs/{run}/frames")[2]
            self.assertEqual(frames[:8], whole[:8])
            history = server.get(f"/api/runs/{run}/history")["history"]
            for rows in seen:  # what was seen is what is kept
                count = len(rows["time"])
                self.assertEqual(rows, {name: history[name][:count] for name in rows})

    def test_what_cannot_run_says_why(self):
        with Server() as server:
            cluster = content(os.path.join(SOURCE, "data/scenes/cargo-cluster.toml")).decode()
            for kind in ("full", "compare"):
                status, answer = server.post("/api/" + kind, {"text": cluster})
                self.assertEqual(status, 422)
                self.assertIn("'full' cannot run this scene", answer["error"]["message"])
            status, answer = server.post("/api/full", {"text": TEXT, "set": ["full.fields_rate=50"]})
            self.assertEqual(status, 422)
            self.assertIn("full.fields_rate", answer["error"]["message"])
            self.assertEqual(server.get("/api/runs"), [])


DATA = os.path.join(SOURCE, "data")
DROPS = os.path.join(DATA, "calibration")
PLAN = content(os.path.join(DATA, "campaigns", "c9-overload.toml")).decode().replace("20000", "2000")


def file_of(name):
    return {"name": name, "text": content(os.path.join(DROPS, name)).decode()}


class Studies(unittest.TestCase):
    """Calibrations and campaigns: their answers are those of the command line, and files come with the request alone."""

    def begin(self, server, kind, **body):
        status, answer = server.post("/api/" + kind, {"text": TEXT, **body})
        self.assertEqual(status, 202, answer)
        return answer["id"]

    def refusal(self, server, kind, status, **body):
        got, answer = server.post("/api/" + kind, {"text": TEXT, **body})
        self.assertEqual(got, status, answer)
        return answer["error"]["message"]

    def test_calibration_is_that_of_the_command_line(self):
        with Server() as server:
            files = [file_of(name) for name in ("c9-drop-b.csv", "c9-drop-a.csv", "c9-drop-a.toml", "c9-drop-b.toml")]
            run = self.begin(server, "calibrate", files=files, set=["payload.mass='150 kg'"])
            state = server.ended(run)
            self.assertEqual((state["kind"], state["state"], state["error"]), ("calibrate", "done", None))
            for one in files:
                with open(os.path.join(server.directory, one["name"]), "w", encoding="utf-8") as file:
                    file.write(one["text"])
            by_hand = program("calibrate", "drop.toml", "--to", "c9-drop-a.toml", "--to", "c9-drop-b.toml", "--set", "payload.mass='150 kg'", "--json",
                              cwd=server.directory)
            expected, study = json.loads(by_hand.stdout), state["study"]
            for one in (expected, study):
                one["cost"].pop("wall_s")
                one["provenance"] = None
            self.assertEqual(study, expected)
            # Where it would be saved, its base is beside it.
            written = content(os.path.join(server.directory, "drop.out", "calibrated.toml")).decode().replace('"../drop.toml"', '"drop.toml"')
            self.assertEqual(state["scene_text"], written)
            status, headers, page = server.ask("GET", f"/api/runs/{run}/report")
            self.assertEqual((status, b"What is left over" in page), (200, True))
            self.assertIn('filename="calibration.json"', server.ask("GET", f"/api/runs/{run}/summary")[1]["Content-Disposition"])
            for of_models in ("history", "history.csv"):
                self.assertEqual(server.ask("GET", f"/api/runs/{run}/{of_models}")[0], 404, of_models)
            # A text that is not the file's has no file to be based on.
            run = self.begin(server, "calibrate", text=TEXT + "\n", files=[file_of("c9-drop-a.csv")], vary=["parachute.drag_area=20..60"])
            state = server.ended(run)
            self.assertEqual((state["state"], state["scene_text"]), ("done", None))
            self.assertEqual([key for key in state["study"]["parameters"] if not key.startswith("clock")], ["parachute.drag_area"])

    def test_tests_that_are_refused(self):
        series = TEXT + '\n[[case]]\nname = "slow"\nset = { "release.speed" = "20 m/s" }\n'
        with Server() as server:
            before = server.files()
            said = self.refusal(server, "calibrate", 422, files=[file_of("c9-drop-a.toml")])
            self.assertIn("'c9-drop-a.csv' is not among the files", said)
            outside = {"name": "x.toml", "text": 'file = "/etc/passwd"\n'}
            self.assertIn("'/etc/passwd' is not among the files", self.refusal(server, "calibrate", 422, files=[outside]))
            beside = {"name": "x.toml", "text": 'file = "drop.toml"\n'}  # on disk there is one
            self.assertIn("'drop.toml' is not among the files", self.refusal(server, "calibrate", 422, files=[beside]))
            self.assertIn("is there twice", self.refusal(server, "calibrate", 422, files=[file_of("c9-drop-a.csv")] * 2))
            self.assertIn("series", self.refusal(server, "calibrate", 422, text=series, files=[file_of("c9-drop-a.csv")]))
            self.assertIn("c.csv:2:1: too few lines", self.refusal(server, "calibrate", 422, files=[{"name": "c.csv", "text": "a,b\n1,2\n"}]))
            for files in (None, [], "x", ["x"], [{}], [{"name": "../x.csv", "text": ""}], [{"name": "x.csv", "text": 3}]):
                self.refusal(server, "calibrate", 400, files=files)
            self.assertEqual(server.get("/api/runs"), [])
            state = server.ended(self.begin(server, "calibrate", files=[file_of("c9-drop-a.csv")], vary=["winds"]))
            self.assertEqual((state["state"], state["study"]), ("failed", None))
            self.assertIn("winds", state["error"])
            self.assertEqual(server.files(), before)

    def test_campaign_is_that_of_the_command_line(self):
        with Server() as server:
            plan = os.path.join(server.directory, "plan.toml")
            with open(plan, "w", encoding="utf-8") as file:
                # Of its own overrides and those of the page the latter hold, as --set does.
                text = PLAN.replace("schema = 1", """schema = 1\nset = ["release.path_angle='70 deg'", "payload.mass='140 kg'"]""")
                file.write(text.replace("c9-inflation.toml", "drop.toml"))
            by_hand = program("campaign", "plan.toml", "--set", "release.path_angle='80 deg'", "--json", cwd=server.directory)
            if "is not in this build" in by_hand.stderr:
                self.assertIn("is not in this build", self.refusal(server, "campaign", 422, campaign=PLAN))
                self.skipTest("no campaigns in this build")
            before = server.files()
            run = self.begin(server, "campaign", campaign=text, name="plan.toml", set=["release.path_angle='80 deg'"])
            state = server.ended(run)
            self.assertEqual((state["kind"], state["state"], state["error"]), ("campaign", "done", None))
            expected = json.loads(by_hand.stdout)
            for key in ("inputs", "runs", "answers", "sensitivity", "failures", "status", "engine"):
                self.assertEqual(state["study"][key], expected[key], key)
            self.assertEqual(state["study"]["campaign"]["base"], "drop.toml, changed")  # by path_angle
            self.assertIn(b"overload", server.ask("GET", f"/api/runs/{run}/report")[2])
            self.assertEqual(server.files(), before)
            self.assertEqual(os.listdir(server.scratch.name), [])

    def test_campaigns_that_are_refused(self):
        with Server() as server:
            if "is not in this build" in program("campaign", "x.toml").stderr:
                self.skipTest("no campaigns in this build")
            self.assertIn("campaign.toml:", self.refusal(server, "campaign", 422, campaign="[campaign]\n"))
            self.refusal(server, "campaign", 400)
            self.refusal(server, "campaign", 400, campaign=3)
            points = PLAN.replace('design = "sobol"', 'design = "{}"').replace("runs   = 2000", "")
            for name in ("/etc/passwd.csv", "../points.csv", "sub/../../points.csv"):
                self.assertIn("leaves the directory of the scene", self.refusal(server, "campaign", 422, campaign=points.replace("{}", name)), name)
            for name in ("/etc/passwd", "../secret.toml"):
                plan = PLAN + f'\n[[vary]]\ncalibrated = "{name}"\n'
                self.assertIn("leaves the directory of the scene", self.refusal(server, "campaign", 422, campaign=plan), name)
            self.assertEqual(server.get("/api/runs"), [])
            # What the scene has no answer to is said once its first run is there.
            run = self.begin(server, "campaign", campaign=PLAN + '\n[[answer]]\nname = "down"\nmean = "landing_vertical_speed"\n')
            state = server.ended(run)
            self.assertEqual((state["state"], state["study"]), ("failed", None))
            self.assertIn("landing vertical speed", state["error"])

    def test_interrupted_campaign_is_saved(self):
        with Server() as server:
            if "is not in this build" in program("campaign", "x.toml").stderr:
                self.skipTest("no campaigns in this build")
            run = self.begin(server, "campaign", campaign=PLAN.replace("2000", "100000000"))
            while not server.get(f"/api/runs/{run}")["share"]:
                time.sleep(0.05)
            self.assertNotEqual(os.listdir(server.scratch.name), [])
            seconds, code, out = server.end()
            self.assertLess(seconds, PROMPTLY)
            self.assertEqual((code, out), (130, "record    drop.out\n"), server.err)
            found = json.loads(content(os.path.join(server.directory, "drop.out", "campaign.json")))
            self.assertEqual(found["status"], "interrupted")
            self.assertGreater(found["runs"]["made"], 0)
            self.assertIn("report.html", os.listdir(os.path.join(server.directory, "drop.out")))
            self.assertEqual(os.listdir(server.scratch.name), [])


class Ending(unittest.TestCase):
    def test_interrupted_runs_are_saved(self):
        with Server() as server:
            begun = [server.start(kind, ENDLESS) for kind in ("full", "compare")]
            os.mkdir(os.path.join(server.directory, "drop.out"))  # of somebody
            while not all(server.get(f"/api/runs/{run}")["rows"]["time"] for run in begun):
                time.sleep(0.05)
            idle = [socket.create_connection(("127.0.0.1", server.port)) for _ in range(20)]
            for connection in idle[:4]:
                connection.sendall(b"POST /api/rom HTTP/1.1\r\nHost: ")
            time.sleep(0.1)
            seconds, code, out = server.end()
            for connection in idle:
                connection.close()
            self.assertLess(seconds, PROMPTLY)
            self.assertEqual(code, 130, server.err)
            self.assertEqual(out, "record    drop-2.out\nrecord    drop-3.out\n")
            for record, model in (("drop-2.out", "full"), ("drop-3.out/full", "full"), ("drop-3.out/rom", "rom")):
                with open(os.path.join(server.directory, record, "summary.json"), encoding="utf-8") as file:
                    summary = json.load(file)
                self.assertEqual(summary["fidelity"], model)
                if model == "full":
                    self.assertEqual(summary["status"]["code"], "interrupted")
            self.assertEqual(os.listdir(os.path.join(server.directory, "drop.out")), [])
            # They are records as any other.
            self.assertEqual(program("report", os.path.join(server.directory, "drop-3.out"), "--quiet").returncode, 130)

    def test_ends_at_once_without_runs(self):
        for sent in (signal.SIGINT, signal.SIGTERM):
            with Server() as server:
                self.assertEqual(server.ask("GET", "/api/scene")[0], 200)
                begin = time.monotonic()
                server.process.send_signal(sent)
                out, err = server.process.communicate(timeout=30)
                self.assertLess(time.monotonic() - begin, PROMPTLY)
                self.assertEqual((server.process.returncode, out, err), (0, "", ""))
                self.assertEqual(list(server.files()), ["drop.toml"])

    def test_slow_clients_block_for_some_seconds_at_most(self):
        with Server() as server:
            slow = [socket.create_connection(("127.0.0.1", server.port)) for _ in range(8)]
            for connection in slow:
                connection.sendall(b"GET / HT")
            begin = time.monotonic()
            self.assertEqual(server.ask("GET", "/api/scene")[0], 200)
            self.assertLess(time.monotonic() - begin, 5.0 + PROMPTLY)
            for connection in slow:
                connection.close()


class CommandLine(unittest.TestCase):
    def test_bad_usage(self):
        with Server() as server:
            for words, said in ((("--port", str(server.port)), f"port {server.port} cannot be had"), (("--port", "x"), "'--port x'"),
                                (("--port", "65536"), "'--port 65536'"), (("--port", "-1"), "'--port"), (("--dir", "/no/such"), "--dir /no/such"),
                                (("--dir", "/etc/passwd"), "--dir /etc/passwd"), (("no-such.toml",), "no-such.toml: no such file")):
                ended = program("serve", *words, cwd=server.directory)
                self.assertEqual((ended.returncode, ended.stdout), (2, ""), words)
                self.assertIn(said, ended.stderr)
            self.assertEqual(list(server.files()), ["drop.toml"])

    def test_without_a_scene_there_is_an_example(self):
        with Server(scene=None) as server:
            answer = server.get("/api/scene")
            self.assertTrue(answer["file"].endswith("c9-inflation.toml"), answer["file"])
            self.assertEqual(answer["text"], TEXT)
            status, said = server.post("/api/save", {"name": "c9-inflation.toml", "text": "# mine\n"})
            self.assertEqual((status, said["file"]), (200, "c9-inflation.toml"))
            self.assertEqual(server.files()["c9-inflation.toml"], b"# mine\n")

    def test_given_port_and_tokens(self):
        with Server() as one:
            port, token = one.port, one.token
        with Server("--port", str(port)) as two:
            self.assertEqual(two.port, port)
            self.assertNotEqual(two.token, token)


REQUESTS = 10000


class Fuzz(unittest.TestCase):
    """Malformed requests from a seed; then the server answers as before and nothing was written."""

    def request(self, dice, server):
        token = dice.choice([server.token, server.token, "x", ""])
        method = dice.choice(["GET", "POST", "DELETE", "PUT", "", "G\0T", "get", "PRI", "A" * 300])
        path = dice.choice(["/", "/api/rom", "/api/full", "/api/save", "/api/calibrate", "/api/campaign", "/api/runs/1", "/api/scene", "/../../etc/passwd", "/%", "/%zz%00", "*", "",
                            "/api/runs/" + "9" * 40, "/?" + "&=" * 500, "/a?token=" + token, "http://evil/", "/" + "%2e" * 900])
        version = dice.choice(["HTTP/1.1", "HTTP/1.1", "HTTP/1.0", "HTTP/9.9", "", "HTTP/1.1 x"])
        body = dice.choice([b"", b"{", json.dumps({"text": TEXT[: dice.randrange(len(TEXT))], "name": "fuzz.txt"}).encode(),
                            dice.randbytes(dice.randrange(400)), b"[" * 5000, json.dumps({"text": TEXT, "files": [{"name": "x.csv", "text": "time,force\n0," + "9" * dice.randrange(400)}]}).encode(),
                            json.dumps({"text": TEXT, "campaign": PLAN[: dice.randrange(len(PLAN))]}).encode(), json.dumps({"name": "../fuzz.toml", "text": "x"}).encode()])
        length = dice.choice([str(len(body)), str(len(body)), str(len(body) + 5), "-1", "x", "1e9", "99999999999999999999", "0", str(len(body) // 2)])
        lines = [f"{method} {path} {version}".encode(), f"Host: 127.0.0.1:{server.port}".encode(), f"X-Twinchute-Token: {token}".encode(),
                 b"Content-Type: application/json", f"Content-Length: {length}".encode()]
        odd = [b"Transfer-Encoding: chunked", b"Range: bytes=" + b"-," * 2000, b"Expect: 100-continue", b"Connection: Upgrade", b":", b"no colon",
               b"X: " + b"y" * 9000, b"Content-Type: multipart/form-data; boundary=", b"Content-Encoding: br", b" folded", b"\0\0\0",
               b"Content-Length: 3", b"Host: evil", b"Origin: %0d%0aX: y", dice.randbytes(30), b"Range: bytes=9-1", b"Accept-Encoding: br"]
        for _ in range(dice.randrange(3)):
            lines.insert(dice.randrange(len(lines) + 1), dice.choice(odd))
        if dice.random() < 0.3:
            del lines[dice.randrange(len(lines))]
        data = dice.choice([b"\r\n", b"\r\n", b"\r\n", b"\n", b"\r"]).join(lines) + b"\r\n\r\n" + body
        if dice.random() < 0.3:
            data = data[: dice.randrange(len(data) + 1)]
        for _ in range(dice.choice([0, 0, 0, 1, 5])):
            at = dice.randrange(len(data) + 1)
            data = data[:at] + dice.randbytes(dice.randrange(1, 4)) + data[at + dice.randrange(3):]
        return data

    def test_fuzzed_requests(self):
        dice = random.Random(20261126)
        with Server() as server:
            before = server.files()
            answered = 0
            for _ in range(REQUESTS):
                got = server.raw(self.request(dice, server))
                answered += got.startswith(b"HTTP/1.1 ")
                self.assertNotIn(b"root:", got)
            self.assertGreater(answered, REQUESTS / 2)  # most were read to a complaint
            self.assertIsNone(server.process.poll())
            self.assertEqual(server.files(), before)
            status, answer = server.post("/api/rom", {"text": TEXT})
            self.assertEqual(status, 200)
            seconds, code, _ = server.end()
            self.assertLess(seconds, PROMPTLY)
            self.assertIn(code, (0, 130))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[3:])
