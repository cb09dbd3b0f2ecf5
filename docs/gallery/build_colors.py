"""What the gallery's scripts read of a build: its materials."""

import xml.etree.ElementTree as ElementTree

NAMESPACE = "{urn:lamella:build:1}"


def materials(build):
    """Name and colour (three numbers in [0, 1]) of each material, in the order of their ids."""
    root = ElementTree.parse(f"{build}/build.xml").getroot()
    return [(m.get("name"), tuple(float(m.get(c, "0.6")) for c in ("red", "green", "blue")))
            for m in root.iter(NAMESPACE + "material")]
