#!/usr/bin/env python3
"""Validates JSON files with a JSON Schema: check_schema.py SCHEMA FILE... Exit code 77: no jsonschema package."""

import json
import sys

try:
    import jsonschema
except ImportError:
    print("the Python package jsonschema is not installed")
    sys.exit(77)


def main():
    schema_file, *files = sys.argv[1:]
    with open(schema_file, encoding="utf-8") as stream:
        schema = json.load(stream)
    jsonschema.Draft7Validator.check_schema(schema)
    validator = jsonschema.Draft7Validator(schema)
    wrong = 0
    for name in files:
        with open(name, encoding="utf-8") as stream:
            for error in validator.iter_errors(json.load(stream)):
                print(f"{name}: {'/'.join(map(str, error.path))}: {error.message[:300]}")
                wrong = 1
    sys.exit(wrong)


main()
