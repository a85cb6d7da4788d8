#!/usr/bin/env python3
"""How fast `flank lsp` is: editor.py [PROGRAM] [SPECS]. Opens every spec as an editor does, and prints medians and worst times in ms."""

import json
import pathlib
import queue
import statistics
import subprocess
import sys
import threading
import time


class Editor:
    def __init__(self, program):
        self.began = time.perf_counter()
        self.process = subprocess.Popen([program, "lsp"], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        self.messages, self.number, self.version = queue.Queue(), 0, 0
        threading.Thread(target=self.read, daemon=True).start()

    def read(self):
        while True:
            length = 0
            while line := self.process.stdout.readline().strip():
                if line.lower().startswith(b"content-length"):
                    length = int(line.split(b":")[1])
            if length == 0:
                return
            body = self.process.stdout.read(length)
            self.messages.put((time.perf_counter(), json.loads(body)))

    def send(self, **message):
        body = json.dumps({"jsonrpc": "2.0", **message}).encode()
        self.process.stdin.write(b"Content-Length: %d\r\n\r\n" % len(body) + body)
        self.process.stdin.flush()

    def ask(self, method, params):
        """The time of an answer, and the answer."""
        self.number += 1
        began = time.perf_counter()
        self.send(id=self.number, method=method, params=params)
        while True:
            at, message = self.messages.get(timeout=60)
            if message.get("id") == self.number:
                return 1000 * (at - began), message.get("result")

    def told(self, uri, began):
        """When findings of the text as it is now are there."""
        while True:
            at, message = self.messages.get(timeout=60)
            params = message.get("params", {})
            if params.get("uri") == uri and params.get("version") == self.version:
                return 1000 * (at - began)

    def edit(self, uri, method, **params):
        self.version += 1
        document = {"uri": uri, "version": self.version}
        if method == "didOpen":
            document |= {"languageId": "chain", "text": params.pop("text")}
        began = time.perf_counter()
        self.send(method=f"textDocument/{method}", params={"textDocument": document, **params})
        return self.told(uri, began)


def places(text):
    """Places of names: behind a dot, and within words of code."""
    for number, line in enumerate(text.split("\n")):
        code = line.split("//")[0]
        for column in range(1, len(code)):
            if code[column - 1].isalpha() and not code[column].isalnum():
                yield {"line": number, "character": column}


def main():
    # an answer is not to wait for the thread that reads another one
    sys.setswitchinterval(1e-4)
    program = sys.argv[1] if len(sys.argv) > 1 else "target/release/flank"
    specs = sorted(pathlib.Path(sys.argv[2] if len(sys.argv) > 2 else "specs").resolve().rglob("*.chain"))
    starts = []
    for _ in range(20):
        editor = Editor(program)
        editor.ask("initialize", {"processId": None, "rootUri": None, "capabilities": {}})
        starts.append(1000 * (time.perf_counter() - editor.began))
        editor.process.kill()
    editor = Editor(program)
    editor.ask("initialize", {"processId": None, "rootUri": None, "capabilities": {}})
    editor.send(method="initialized", params={})
    times = {"keystroke to findings": [], "hover": [], "completion": [], "definition": []}
    worst = {}
    for spec in specs:
        uri, text = spec.as_uri(), spec.read_text()
        editor.edit(uri, "didOpen", text=text)
        end = {"line": text.count("\n"), "character": 0}
        change = {"range": {"start": end, "end": end}, "text": "// a keystroke\n"}
        took = {"keystroke to findings": [editor.edit(uri, "didChange", contentChanges=[change]) for _ in range(3)]}
        at = list(places(text))
        for what in ["hover", "completion", "definition"]:
            asked = at[:: max(1, len(at) // 8)]
            params = [{"textDocument": {"uri": uri}, "position": place} for place in asked]
            took[what] = [editor.ask(f"textDocument/{what}", one)[0] for one in params]
        for what, found in took.items():
            times[what] += found
            if found and max(found) > worst.get(what, (0, ""))[0]:
                worst[what] = (max(found), spec.name)
    print(f"{len(specs)} specs open at a time")
    print(f"start to answer: median {statistics.median(starts):.1f}, worst {max(starts):.1f}")
    for what, found in times.items():
        found.sort()
        high = found[int(0.95 * len(found))]
        print(f"{what}: median {statistics.median(found):.1f}, 95 % below {high:.1f}, worst {worst[what][0]:.1f} ({worst[what][1]})")
    status = pathlib.Path(f"/proc/{editor.process.pid}/status")
    if status.exists():
        line = next(line for line in status.read_text().splitlines() if line.startswith("VmHWM"))
        print(f"memory: {int(line.split()[1]) / 1024:.0f} MiB at most")
    editor.process.kill()


main()
