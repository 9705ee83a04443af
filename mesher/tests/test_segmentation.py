"""Segmentations of 3D Slicer from the file to the mesh: names, colours and layers."""

import gzip
import json
import os
import re
import unittest

from podm_process import PROGRAM, PodmTestCase, run_podm
from small_images import voxels_of

VERIFIER = os.path.join(os.path.dirname(PROGRAM), "podm-verify")
SIZE = 16
OBLIQUE = "(0.6,0.8,0) (-0.8,0.6,0) (0,0,-1)"


def ball(radius):
    """Returns 1 in a ball, as bytes."""
    return voxels_of(SIZE, lambda *ijk: sum((x - 7.5) ** 2 for x in ijk) <= radius**2)


BONE, SKIN = ball(3.5), ball(6.5)


def segmentation(layers, segments, encoding="raw", directions="(1,0,0) (0,1,0) (0,0,1)", layer_axis=0):
    """Returns the bytes of a .seg.nrrd. A segment is (name, layer, label value, colour). The layers, if there are
    several, are axis `layer_axis` of the file."""
    count = len(layers)

    def with_layers(of_layers, *of_space):
        axes = [*of_space[:layer_axis], of_layers, *of_space[layer_axis:]] if count > 1 else of_space
        return " ".join(map(str, axes))

    fields = ["type: unsigned char", f"dimension: {3 + (count > 1)}", "space: left-posterior-superior",
              f"sizes: {with_layers(count, SIZE, SIZE, SIZE)}",
              f"space directions: {with_layers('none', *directions.split())}",
              f"kinds: {with_layers('list', *3 * ['domain'])}", f"encoding: {encoding}", "space origin: (3,4,5)"]
    for number, (name, layer, value, colour) in enumerate(segments):
        prefix = f"Segment{number}_"
        fields += [f"{prefix}Color:={colour}", f"{prefix}Extent:=0 15 0 15 0 15", f"{prefix}ID:=Segment_{number}",
                   f"{prefix}LabelValue:={value}", f"{prefix}Layer:={layer}", f"{prefix}Name:={name}"]
    step = SIZE**layer_axis  # voxels of one layer before some of the next
    voxels = b"".join(layer[first:first + step] for first in range(0, SIZE**3, step) for layer in layers)
    return ("NRRD0004\n" + "\n".join(fields) + "\n\n").encode() + (
        gzip.compress(voxels) if encoding == "gzip" else voxels)


SKIN_FIRST = [("skin", 0, 1, "1 0.8 0.6"), ("long bone", 1, 1, "0 0 1")]
BONE_FIRST = [("long bone", 1, 1, "0 0 1"), ("skin", 0, 1, "1 0.8 0.6")]


class SegmentationTest(PodmTestCase):
    def write(self, segments=SKIN_FIRST, name="arm.seg.nrrd", **options):
        path = self.folder / name
        path.write_bytes(segmentation([SKIN, BONE], segments, **options))
        return path

    def info(self, *arguments):
        process = run_podm("info", "--json", *arguments)
        self.assert_exit(process, 0)
        return json.loads(process.stdout)

    def mesh(self, image, name, *options, radius=3):
        process = run_podm("mesh", image, "--radius", radius, "--threads", 1, "-o", self.folder / name, *options)
        self.assert_exit(process, 0)
        return process

    def field_data(self, path):
        """Returns the label values by name, and the colours by value, in a VTU file."""
        head = path.read_bytes().split(b"<Piece")[0].decode()
        names = {name: int(value) for name, value in re.findall(r'Name="label:([^"]*)"[^>]*>(\d+)<', head)}
        colours = re.findall(r'Name="label_colours"[^>]*>([^<]*)<', head)
        rows = [[int(word) for word in row.split()] for row in (colours[0] if colours else "").splitlines()]
        return names, {value: tuple(colour) for value, *colour in rows}

    def test_names_colours_and_layers_are_described(self):
        for encoding in "raw", "gzip":
            with self.subTest(encoding=encoding):
                info = self.info(self.write(encoding=encoding))
                self.assertEqual([(label["value"], label["name"], label["colour"]) for label in info["labels"]],
                                 [(1, "skin", "#ffcc99"), (2, "long bone", "#0000ff")])
                bone, skin = sum(BONE), sum(SKIN)
                self.assertEqual([label["voxels"] for label in info["labels"]], [skin - bone, bone])
                self.assertEqual([[of[key] for key in ("label", "layer", "stored_value", "voxels", "covered_voxels")]
                                  for of in info["segments"]], [[1, 0, 1, skin, bone], [2, 1, 1, bone, 0]])
        text = run_podm("info", self.folder / "arm.seg.nrrd")
        self.assertRegex(text.stdout, r"#0000ff +long bone")
        self.assertRegex(text.stdout, rf"1 +{sum(SKIN)} +{sum(BONE)} +0 +skin")
        self.assertIn("numbered in the order of segments: 1 skin, 2 long bone", text.stderr)
        self.assertIn(f"{sum(BONE)} of the {sum(SKIN)} voxels of segment 'skin' (layer 0)", text.stderr)

    def test_segments_of_one_layer_are_counted(self):
        path = self.folder / "one.seg.nrrd"
        path.write_bytes(segmentation([SKIN], [("skin", 0, 1, "1 0 0"), ("nothing", 0, 2, "0 1 0")]))
        self.assertEqual([(of["name"], of["voxels"], of["covered_voxels"]) for of in self.info(path)["segments"]],
                         [("skin", sum(SKIN), 0), ("nothing", 0, 0)])

    def test_the_mesh_is_that_of_a_plain_image_merged_by_hand(self):
        by_hand = self.folder / "plain.nrrd"
        merged = bytes(2 if bone else skin for skin, bone in zip(SKIN, BONE))
        for directions in "(1,0,0) (0,1,0) (0,0,1)", OBLIQUE:
            by_hand.write_bytes(segmentation([merged], [], directions=directions))
            self.mesh(by_hand, "plain.mesh")
            for layer_axis in 0, 1, 3:
                arm = self.write(directions=directions, encoding="gzip", layer_axis=layer_axis)
                self.mesh(arm, "arm.mesh", "--verify")
                plain, of_segments = ([line for line in (self.folder / name).read_text().splitlines() if line[0] != "#"]
                                      for name in ("plain.mesh", "arm.mesh"))
                self.assertEqual(of_segments, plain)

    def test_names_and_colours_arrive_in_the_files(self):
        self.mesh(self.write(), "arm.vtu", "--verify")
        expected = ({"outside": 0, "skin": 1, "long bone": 2}, {1: (255, 204, 153), 2: (0, 0, 255)})
        self.assertEqual(self.field_data(self.folder / "arm.vtu"), expected)
        self.assertEqual(self.field_data(self.folder / "arm_facets.vtu"), expected)
        for name in "arm.vtk", "arm.msh", "arm.e", "arm.mesh", "arm.ele":
            with self.subTest(name=name):
                self.mesh(self.folder / "arm.seg.nrrd", name)
                back = self.folder / "back.vtu"
                self.assert_exit(run_podm("convert", self.folder / name, back), 0)
                names, colours = self.field_data(back)
                self.assertEqual(names, expected[0])
                self.assertEqual(colours, expected[1] if name == "arm.vtk" else {})

    def test_labels_are_selected_by_name(self):
        arm = self.write()
        self.mesh(arm, "arm.vtu", "--radius-of", "long bone=1.5", "--size-near", "skin,long bone=1:1", "--verify")
        self.assert_refused(["mesh", arm, "--radius-of", "long bon=1", "-o", self.folder / "b.vtu"],
                            "did you mean 'long bone'")

    def test_layers_are_ordered_and_chosen(self):
        arm = self.write(BONE_FIRST)
        record = self.folder / "runs.jsonl"
        for layers, values in (None, [2]), ("0,1", [1, 2]), ("1,0", [2]), ("0", [2]), ("1", [1]):
            with self.subTest(layers=layers):
                options = ["--layers", layers] if layers else []
                self.assertEqual([label["value"] for label in self.info(arm, *options)["labels"]], values)
                record.unlink(missing_ok=True)
                self.mesh(arm, "arm.vtu", "--verify", "--record", record, *options)
                made = self.read_record(record)
                expected = [int(layer) for layer in layers.split(",")] if layers else []
                self.assertEqual(made["options"]["labels"]["layers"], expected)
                self.assertTrue(any("share label values" in text for text in made["warnings"]))

    def test_the_verifier_merges_by_itself(self):
        arm, mesh = self.write(), self.folder / "arm.vtu"
        self.mesh(arm, mesh.name)
        verifier = self.folder / "report.json"
        for layers, is_right in (None, True), ("0,1", True), ("1,0", False), ("0", False):
            with self.subTest(layers=layers):
                process = run_podm(mesh, "--image", arm, "--claims", "labels,surface_vertices", "--json", verifier,
                                   *(["--layers", layers] if layers else []),
                                   program=VERIFIER)
                self.assert_exit(process, 0 if is_right else 1)

    def test_what_is_dropped_covers_nothing(self):
        arm = self.write(BONE_FIRST)  # the skin covers the bone
        info = self.info(arm, "--drop", "2")
        self.assertEqual([(label["value"], label["voxels"]) for label in info["labels"]], [(1, sum(BONE))])
        self.mesh(arm, "bone.vtu", "--drop", "2", "--verify")
        self.mesh(arm, "bone.vtu", "--labels", "1", "--verify")

    def test_a_table_replaces_names_and_colours(self):
        table = self.folder / "colours.ctbl"
        table.write_text("# Color table file\n0 background 0 0 0 0\n1 Haut 1 2 3 255\n")
        self.mesh(self.write(), "arm.vtu", "--label-names", table)
        self.assertEqual(self.field_data(self.folder / "arm.vtu"),
                         ({"outside": 0, "Haut": 1, "long bone": 2}, {1: (1, 2, 3), 2: (0, 0, 255)}))

    def test_files_without_colours_have_no_array_of_colours(self):
        self.mesh("phantom:spheres@16", "a.vtu")
        self.assertNotIn(b"label_colours", (self.folder / "a.vtu").read_bytes())

    def test_one_layer(self):
        one = self.folder / "one.seg.nrrd"
        both = bytes(2 if bone else skin for skin, bone in zip(SKIN, BONE))
        one.write_bytes(segmentation([both], [("skin", 0, 1, "1 0 0"), ("bone", 0, 2, "0 1 0")]))
        info = self.info(one)
        self.assertEqual([label["name"] for label in info["labels"]], ["skin", "bone"])
        self.assertEqual(info["warnings"], [])
        self.mesh(one, "one.vtu", "--verify", "--layers", "0")

    def test_the_volume_of_the_mesh_is_that_of_the_voxels(self):
        record = self.folder / "runs.jsonl"
        self.mesh(self.write(), "arm.vtu", "--record", record, radius=1)
        volumes = {label["name"]: label["volume_mm3"] for label in self.read_record(record)["labels"]}
        for volume, voxels in ((volumes["long bone"], sum(BONE)), (sum(volumes.values()), sum(SKIN))):  # of 1 mm^3
            self.assertAlmostEqual(volume / voxels, 1, delta=0.1)

    def test_bad_headers_are_refused(self):
        good = segmentation([SKIN, BONE], SKIN_FIRST)
        path = self.folder / "bad.seg.nrrd"
        for old, new, *words in (
                (b"Segment1_LabelValue:=1\n", b"", "Segment1 has no label value"),
                (b"Segment1_Layer:=1", b"Segment1_Layer:=0", "have the same label value 1 in layer 0"),
                (b"Segment1_Layer:=1", b"Segment1_Layer:=5", "Segment1_Layer '5'"),
                (b"Segment0_Extent:=0 15 ", b"Segment0_Extent:=0 x ", "Segment0_Extent"),
                (b"Segment0_Color:=1 0.8 0.6", b"Segment0_Color:=#ffcc99", "Segment0_Color '#ffcc99'")):
            with self.subTest(new=new):
                self.assertIn(old, good)
                path.write_bytes(good.replace(old, new))
                self.assert_refused(["mesh", path, "-o", self.folder / "bad.vtu"], path.name, *words)
        path.write_bytes(good)
        self.assert_refused(["mesh", path, "--layers", "0,2", "-o", self.folder / "bad.vtu"], path.name,
                            "--layers: layer 2 is not in the image")
        self.assert_refused(["mesh", path, "--layers", "1,1", "-o", self.folder / "bad.vtu"], "given twice")
        self.assert_refused(["mesh", "phantom:spheres@16", "--layers", "0", "-o", self.folder / "bad.vtu"], "no layers")


if __name__ == "__main__":
    unittest.main()
