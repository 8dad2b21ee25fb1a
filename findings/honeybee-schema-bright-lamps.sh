#!/usr/bin/env bash
# honeybee-schema 2.3.0 and honeybee-radiance 1.66.299: a `Light` modifier of 10 W/(m² sr), which Radiance takes for 1790 cd/m².
# honeybee-radiance makes it, writes it for Radiance, and reads its own dictionary again. The published schema of the same
# dictionary refuses all radiances above 1, as if they were reflectances. `Glow` likewise.
set -euo pipefail
folder=$(mktemp -d); trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check 'honeybee-radiance==1.66.299' 'honeybee-schema==2.3.0' 'honeybee-core==1.64.79'
cd "$folder"
"$folder/venv/bin/python" - <<'PYTHON'
from importlib.metadata import version

from honeybee_radiance.modifier.material import Glow, Light
from honeybee_schema.radiance import modifier as schema


def taken(kind, radiance):
    """Does the schema take a lamp that honeybee-radiance takes?"""
    made = kind("lamp", radiance, radiance, radiance)
    assert f"3 {radiance}" in made.to_radiance() or f"4 {radiance}" in made.to_radiance()
    assert kind.from_dict(made.to_dict()) == made
    try:
        getattr(schema, kind.__name__).model_validate(made.to_dict())
    except ValueError:
        return False
    return True


print("honeybee-radiance", version("honeybee-radiance"), "honeybee-schema", version("honeybee-schema"))
found = {(kind.__name__, radiance): taken(kind, radiance) for kind in (Light, Glow) for radiance in (1.0, 10.0)}
print("taken by the schema:", found)
assert found == {("Light", 1.0): True, ("Light", 10.0): False, ("Glow", 1.0): True, ("Glow", 10.0): False}, "the behaviour has changed"
PYTHON
echo 'as stated: the schema takes no lamps brighter than 1'
