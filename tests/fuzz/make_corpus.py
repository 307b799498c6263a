#!/usr/bin/env python3
"""Writes the seeds of the fuzz targets: tiny valid files of every format, one folder a target. Usage: make_corpus.py FOLDER"""
import base64
import json
import pathlib
import struct
import sys
import zlib


def png(bit_depth, color_type, interlace=0):
    """4 x 3 pixels; every filter type once."""
    channels = {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}[color_type]
    row_bytes = (4 * channels * bit_depth + 7) // 8

    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    rows = b"".join(bytes([y % 5]) + bytes((17 * y + 5 * i) % (4 if color_type == 3 else 256) for i in range(row_bytes)) for y in range(3))
    body = chunk(b"IHDR", struct.pack(">IIBBBBB", 4, 3, bit_depth, color_type, 0, 0, interlace))
    if color_type == 3:
        body += chunk(b"PLTE", bytes(range(12)))
    return b"\x89PNG\r\n\x1a\n" + body + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


def exr(compression, pixel_type):
    """8 x 4 pixels, channels B G R, in scanlines; compression 0 (none) or 3 (zip)."""
    width, height, size = 8, 4, {1: 2, 2: 4}[pixel_type]

    def attribute(name, kind, value):
        return name + b"\0" + kind + b"\0" + struct.pack("<I", len(value)) + value

    channels = b"".join(name + b"\0" + struct.pack("<IIII", pixel_type, 0, 1, 1) for name in (b"B", b"G", b"R")) + b"\0"
    window = struct.pack("<iiii", 0, 0, width - 1, height - 1)
    header = struct.pack("<II", 20000630, 2) + b"".join([
        attribute(b"channels", b"chlist", channels), attribute(b"compression", b"compression", bytes([compression])),
        attribute(b"dataWindow", b"box2i", window), attribute(b"displayWindow", b"box2i", window),
        attribute(b"lineOrder", b"lineOrder", b"\0"), attribute(b"pixelAspectRatio", b"float", struct.pack("<f", 1)),
        attribute(b"screenWindowCenter", b"v2f", struct.pack("<ff", 0, 0)), attribute(b"screenWindowWidth", b"float", struct.pack("<f", 1))]) + b"\0"
    lines_a_block = 16 if compression == 3 else 1
    blocks = []
    for y in range(0, height, lines_a_block):
        lines = min(lines_a_block, height - y)
        raw = struct.pack("<e" if size == 2 else "<f", 0.5) * (3 * width * lines)
        if compression == 3:
            split = raw[0::2] + raw[1::2]
            packed = zlib.compress(bytes([split[0]] + [(split[i] - split[i - 1] + 128) & 255 for i in range(1, len(split))]))
            raw = packed if len(packed) < len(raw) else raw
        blocks.append(struct.pack("<iI", y, len(raw)) + raw)
    offset, table = len(header) + 8 * len(blocks), b""
    for block in blocks:
        table += struct.pack("<Q", offset)
        offset += len(block)
    return header + table + b"".join(blocks)


def hdr(new_rle):
    text = b"#?RADIANCE\nEXPOSURE=1\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 8\n"
    if not new_rle:
        return text + bytes([128, 64, 32, 129]) * 16
    line = bytes([2, 2, 0, 8]) + b"".join(bytes([136, value]) for value in (128, 64, 32)) + bytes([8]) + bytes([129] * 8)
    return text + line * 2


def tga(image_type, bits):
    header = struct.pack("<BBBHHBHHHHBB", 0, 0, image_type, 0, 0, 0, 0, 0, 4, 2, bits, 0x20)
    pixel = bytes(range(1, bits // 8 + 1))
    return header + (pixel * 8 if image_type < 8 else (bytes([0x83]) + pixel) * 2)


def bmp():
    pixels = (bytes([10, 20, 30]) * 4) * 2
    return b"BM" + struct.pack("<IHHI", 54 + len(pixels), 0, 0, 54) + struct.pack("<IiiHHIIiiII", 40, 4, 2, 1, 24, 0, len(pixels), 0, 0, 0, 0) + pixels


# An 8 x 8 grey baseline JPEG: one quantisation table of ones, and Huffman tables with the two codes it needs.
def jpeg():
    def segment(marker, body):
        return bytes([0xFF, marker]) + struct.pack(">H", len(body) + 2) + body

    dc_table = bytes([0x00] + [1] + [0] * 15 + [0])
    ac_table = bytes([0x10] + [1] + [0] * 15 + [0])
    return (b"\xff\xd8" + segment(0xDB, bytes([0]) + bytes([1] * 64)) + segment(0xC0, struct.pack(">BHHBBBB", 8, 8, 8, 1, 1, 0x11, 0)) +
            segment(0xC4, dc_table) + segment(0xC4, ac_table) + segment(0xDA, bytes([1, 1, 0x00, 0, 63, 0])) + b"\x3f" + b"\xff\xd9")


def gltf():
    positions = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0)
    indices = struct.pack("<3H", 0, 1, 2) + b"\0\0"
    times = struct.pack("<2f", 0, 1) + struct.pack("<6f", 0, 0, 0, 1, 2, 3)
    data = positions + indices + times
    document = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1, 2]}],
        "nodes": [{"mesh": 0, "translation": [0, 0, -2], "children": [3]}, {"camera": 0}, {"extensions": {"KHR_lights_punctual": {"light": 0}}}, {"mesh": 0, "scale": [1, 2, 3]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
        "materials": [{"name": "m", "pbrMetallicRoughness": {"baseColorFactor": [1, 0.5, 0.2, 1], "metallicFactor": 0.1, "baseColorTexture": {"index": 0, "extensions": {"KHR_texture_transform": {"scale": [2, 2]}}}},
                       "alphaMode": "MASK", "doubleSided": True, "emissiveFactor": [1, 1, 1], "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 3}}}],
        "textures": [{"source": 0, "sampler": 0}], "samplers": [{"wrapS": 33071, "magFilter": 9728}],
        "images": [{"uri": "data:image/png;base64," + base64.b64encode(png(8, 2)).decode()}],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 0.8, "znear": 0.1}}],
        "animations": [{"channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}], "samplers": [{"input": 2, "output": 3}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]},
                      {"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"},
                      {"bufferView": 2, "componentType": 5126, "count": 2, "type": "SCALAR"},
                      {"bufferView": 2, "byteOffset": 8, "componentType": 5126, "count": 2, "type": "VEC3",
                       "sparse": {"count": 1, "indices": {"bufferView": 1, "componentType": 5123}, "values": {"bufferView": 0}}}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 8}, {"buffer": 0, "byteOffset": 44, "byteLength": 32}],
        "extensionsUsed": ["KHR_lights_punctual", "KHR_texture_transform"],
        "extensions": {"KHR_lights_punctual": {"lights": [{"type": "spot", "intensity": 5, "spot": {"outerConeAngle": 0.5}}]}},
    }
    embedded = dict(document, buffers=[{"byteLength": len(data), "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()}])
    text = json.dumps(dict(document, buffers=[{"byteLength": len(data)}]), separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    binary = data + b"\0" * (-len(data) % 4)
    glb = struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(binary)) + struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(binary), b"BIN\0") + binary
    return {"triangle.gltf": json.dumps(embedded).encode(), "triangle.glb": glb, "bent.gltf": bent_gltf()}


def bent_gltf():
    """A skinned triangle with two morph targets whose weights and one joint are animated."""
    parts = [struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0), bytes([0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0]),
             bytes([255, 0, 0, 0, 255, 0, 0, 0, 128, 127, 0, 0]),
             struct.pack("<32f", 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -1, 0, 0, 1),
             struct.pack("<2f", 0, 1), struct.pack("<8f", 0, 0, 0, 1, 0, 0, 0.7, 0.7), struct.pack("<12f", *range(12))]
    types = [("VEC3", 5126, 3), ("VEC4", 5121, 3), ("VEC4", 5121, 3), ("MAT4", 5126, 2), ("SCALAR", 5126, 2), ("VEC4", 5126, 2), ("SCALAR", 5126, 12)]
    data = b"".join(parts)
    document = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
        "nodes": [{"mesh": 0, "skin": 0}, {"children": [2]}, {"translation": [1, 0, 0]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 0, "JOINTS_0": 1, "WEIGHTS_0": 2}, "targets": [{"POSITION": 0}, {"NORMAL": 0}]}],
                    "weights": [0.5, 0]}],
        "skins": [{"joints": [1, 2], "inverseBindMatrices": 3}],
        "animations": [{"channels": [{"sampler": 0, "target": {"node": 2, "path": "rotation"}}, {"sampler": 1, "target": {"node": 0, "path": "weights"}}],
                        "samplers": [{"input": 4, "output": 5}, {"input": 4, "output": 6, "interpolation": "CUBICSPLINE"}]}],
        "accessors": [{"bufferView": i, "type": t, "componentType": c, "count": n, "normalized": i == 2} for i, (t, c, n) in enumerate(types)],
        "bufferViews": [{"buffer": 0, "byteOffset": sum(map(len, parts[:i])), "byteLength": len(part)} for i, part in enumerate(parts)],
        "buffers": [{"byteLength": len(data), "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()}],
    }
    return json.dumps(document).encode()


PBRT = b"""# every directive once
Film "rgb" "integer xresolution" [ 8 ] "integer yresolution" [ 4 ] "string filename" "a.exr"
LookAt 0 0 5  0 0 0  0 1 0
Camera "perspective" "float fov" [ 40 ]
Sampler "independent" "integer pixelsamples" [ 4 ]
Integrator "path" "integer maxdepth" [ 3 ]
WorldBegin
MakeNamedMedium "m" "string type" "homogeneous" "rgb sigma_a" [ 1 0.5 0.25 ]
Texture "t" "spectrum" "checkerboard" "rgb tex1" [ 0.1 0.2 0.3 ] "float uscale" 4
MakeNamedMaterial "red" "string type" [ "diffuse" ] "rgb reflectance" [ 0.6 0.1 0.1 ]
MakeNamedMaterial "mixed" "string type" "mix" "string materials" [ "red" "red" ] "float amount" 0.25
LightSource "infinite" "rgb L" [ 0.4 0.45 0.5 ]
LightSource "point" "point3 from" [ 0 3 0 ] "blackbody I" [ 3000 ]
AttributeBegin
  AreaLightSource "diffuse" "rgb L" [ 5 5 5 ]
  Translate 0 2 0
  Rotate 90 1 0 0
  Scale -1 1 1
  Shape "disk" "float radius" 0.5
AttributeEnd
ObjectBegin "o"
  NamedMaterial "red"
  Shape "trianglemesh" "integer indices" [ 0 1 2 ] "point3 P" [ 0 0 0 1 0 0 0 1 0 ] "point2 uv" [ 0 0 1 0 0 1 ]
ObjectEnd
AttributeBegin
  ConcatTransform [ 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 ]
  ObjectInstance "o"
AttributeEnd
Material "coateddiffuse" "texture reflectance" "t" "float roughness" 0.1
Shape "sphere" "float radius" 1
"""

OBJ = b"""mtllib a.mtl
o one
v 0 0 0
v 1 0 0 1 0.5 0.25
v 1 1 0
v 0 1 0
vt 0 0
vt 1 1
vn 0 0 1
g g1
usemtl a
s 1
f 1/1/1 2/2/1 3//1
f -4 -3 -2 -1
l 1 2
"""


def ply():
    head = "ply\nformat {} 1.0\ncomment c\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
    values = [(0, 0, 0, 255), (1, 0, 0, 128), (0, 1, 0, 0)]
    files = {"ascii.ply": (head.format("ascii") + "".join("%g %g %g %d\n" % v for v in values) + "3 0 1 2\n").encode()}
    for name, order in (("binary_little_endian", "<"), ("binary_big_endian", ">")):
        files[name + ".ply"] = head.format(name).encode() + b"".join(struct.pack(order + "fffB", *v) for v in values) + struct.pack(order + "Biii", 3, 0, 1, 2)
    return files


def frame():
    """A checkpoint of 2 x 1 pixels in an uncompressed zstd block; the fuzz target mends the checksum, which is 0 here."""
    header = json.dumps({"width": 2, "height": 1, "layers": 1, "first_sample": 0, "identity": "i", "note": "{}", "nonfinite": 0}).encode()
    raw = struct.pack("<I", 1) + struct.pack("<qQ", 0, 1 << 63) * 6
    payload = struct.pack("<IBB", 0xFD2FB528, 0x20, len(raw)) + struct.pack("<I", len(raw) << 3 | 1)[:3] + raw
    return b"SLFRAME1" + struct.pack("<QQQ", len(header), len(payload), 0) + header + payload


BRDF = b"""# a paint
# wavelengths
3
450 550 650
# theta_i phi_i theta_o phi_o f...
0.1 0 0.2 3.1415 0.1 0.2 0.3
0.4 0 0.5 -1.5 0.05 .2 1e-1
1.5 1 1.2 0 20 20 20
"""

def bake():
    """Two sections; checksums are left to the target, which mends them."""
    contents = {b"tables": bytes(range(200)), b"nodes": b"0123456789abcdef"}
    at, table, body = 128 + 64 * len(contents), b"", b""
    for name, content in contents.items():
        padding = (at + len(content) + 127) // 64 * 64 - at - len(content)
        table += struct.pack("<32sQQQQ", name, at, len(content), 0, 0)
        body += content + bytes(padding)
        at += len(content) + padding
    return struct.pack("<8sIIQQQQII64s8x", b"SLBAKE\r\n", 1, len(contents), 0, at, 1, 2, 3, 0, b"square-lights.lights") + table + body


SEEDS = {
    "image_png": {f"{depth}-{kind}.png": png(depth, kind) for depth, kind in ((8, 2), (8, 6), (16, 2), (8, 0), (1, 0), (2, 3), (8, 4))},
    "image_exr": {"none-float.exr": exr(0, 2), "zip-half.exr": exr(3, 1)},
    "image_hdr": {"flat.hdr": hdr(False), "rle.hdr": hdr(True)},
    "image_pfm": {"color.pfm": b"PF\n2 2\n-1.0\n" + struct.pack("<12f", *range(12)), "grey.pfm": b"Pf\n2 2\n1.0\n" + struct.pack(">4f", *range(4))},
    "image_jpeg": {"grey.jpg": jpeg()},
    "image_tga_bmp": {"plain.tga": tga(2, 24), "packed.tga": tga(10, 32), "a.bmp": bmp()},
    "gltf": gltf(),
    "pbrt": {"all.pbrt": PBRT},
    "obj": {"square.obj": OBJ},
    "ply": ply(),
    "frame": {"tiny.frame": frame()},
    "brdf": {"paint.brdf": BRDF},
    "bake": {"two.bake": bake()},
}


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    for target, files in SEEDS.items():
        folder = pathlib.Path(sys.argv[1]) / target
        folder.mkdir(parents=True, exist_ok=True)
        for name, content in files.items():
            (folder / name).write_bytes(content)


if __name__ == "__main__":
    main()
