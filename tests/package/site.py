#!/usr/bin/env python3
"""Makes the site and follows its links: site.py BUILD PROGRAM

Every key that PROGRAM lists has an entry with an anchor; every link and picture of a page has its file and its anchor.
"""

import html.parser
import json
import os
import subprocess
import sys
import urllib.parse


class Page(html.parser.HTMLParser):
    def __init__(self, path):
        super().__init__()
        self.anchors, self.links = set(), []
        with open(path, encoding="utf-8") as file:
            self.feed(file.read())

    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            if name == "id" or (tag == "a" and name == "name"):
                self.anchors.add(value)
            if name in ("href", "src") and value and not urllib.parse.urlparse(value).scheme:
                self.links.append(urllib.parse.unquote(value))


build, program = sys.argv[1:3]
subprocess.run(["cmake", "--build", build, "--target", "site"], check=True)
site = os.path.join(build, "site")
files = [os.path.join(at, name) for at, _, names in os.walk(site) for name in names if name.endswith(".html")]
pages = {os.path.relpath(file, site): Page(file) for file in files if not os.path.relpath(file, site).startswith("api/")}
bad = []
for name, page in pages.items():
    for link in page.links:
        path, _, anchor = link.partition("#")
        target = os.path.normpath(os.path.join(os.path.dirname(name), path.split("?")[0])) if path else name
        if not os.path.exists(os.path.join(site, target)):
            bad.append(f"{name}: {link} leads nowhere")
        elif anchor and target in pages and anchor not in pages[target].anchors:
            bad.append(f"{name}: {target} has no #{anchor}")
keys = json.loads(subprocess.run([program, "list", "keys", "--json"], check=True, capture_output=True, text=True).stdout)
bad += [f"no entry of {row['key']}" for row in keys if row["key"] not in pages["docs/guide/keys.html"].anchors]
if len(pages) < 35 or len(keys) < 200:
    bad.append(f"only {len(pages)} pages and {len(keys)} keys")
if not os.path.exists(os.path.join(site, "searchindex.js")):
    bad.append("no search")
print("\n".join(bad) or f"{len(pages)} pages, {sum(len(page.links) for page in pages.values())} links, {len(keys)} keys")
sys.exit(1 if bad else 0)
