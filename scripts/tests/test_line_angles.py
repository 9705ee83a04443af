"""Tests the facets and angles that scripts/check_line_angles measures."""
import unittest

import numpy

import paths  # noqa: F401
from line_angles.bubbles import CENTERS, FROM_AXIS_MM, RADIUS_MM, normals
from line_angles.facets import are_at_lines, areas_and_normals, errors_deg, interface_facets

# Three tetrahedra around the edge of vertices 0 and 1, and a fourth one beyond a facet of the first.
POINTS = numpy.array([[0, 0, -1], [0, 0, 1], [1, 0, 0], [-1, 1, 0], [-1, -1, 0], [1, 2, 0]], float)
CELLS = numpy.array([[0, 1, 2, 3], [0, 1, 3, 4], [0, 1, 4, 2], [0, 2, 3, 5]])


class Facets(unittest.TestCase):
    def test_interfaces_are_between_labels_and_at_the_outside(self):
        facets, sides = interface_facets(CELLS, numpy.array([1, 2, 2, 1]))
        found = {tuple(facet): set(pair) for facet, pair in zip(facets.tolist(), sides.tolist())}
        self.assertEqual(found[0, 1, 3], {1, 2})
        self.assertEqual(found[0, 1, 2], {1, 2})
        self.assertNotIn((0, 1, 4), found, "both cells have label 2")
        self.assertNotIn((0, 2, 3), found)
        self.assertEqual(found[1, 2, 3], {0, 1})

    def test_a_facet_is_at_a_line_if_three_labels_meet_at_an_edge(self):
        def at_lines(labels):
            facets, sides = interface_facets(CELLS[:3], numpy.array(labels))
            return {tuple(facet) for facet, at in zip(facets.tolist(), are_at_lines(facets, sides)) if at}
        self.assertEqual(at_lines([1, 1, 1]), set())
        self.assertIn((0, 1, 2), at_lines([1, 2, 3]))
        self.assertIn((0, 2, 3), at_lines([1, 2, 2]), "two labels and the outside meet at the edge of 0 and 3")

    def test_areas_and_angles(self):
        areas, found = areas_and_normals(POINTS, numpy.array([[0, 1, 2], [2, 3, 4]]))
        numpy.testing.assert_allclose(areas, [1, 2])
        numpy.testing.assert_allclose(abs(found), [[0, 1, 0], [0, 0, 1]])
        tilted = numpy.array([[0, numpy.cos(0.1), numpy.sin(0.1)], [0, 0, -1]])
        numpy.testing.assert_allclose(errors_deg(found, tilted), [numpy.degrees(0.1), 0], atol=1e-6)


class Bubbles(unittest.TestCase):
    def test_normals_are_those_of_spheres_and_of_planes_between_them(self):
        outside = CENTERS[1] + RADIUS_MM * numpy.array([0, 0, 1])
        found = normals(numpy.array([outside, [0, 0, 3]]), numpy.array([[2, 0], [1, 3]]))
        numpy.testing.assert_allclose(found[0], [0, 0, 1], atol=1e-12)
        way = CENTERS[2] - CENTERS[0]
        numpy.testing.assert_allclose(found[1], way / numpy.linalg.norm(way))

    def test_all_spheres_meet_on_the_axis(self):
        self.assertLess(FROM_AXIS_MM, RADIUS_MM)
        numpy.testing.assert_allclose(numpy.linalg.norm(CENTERS, axis=1), FROM_AXIS_MM)


if __name__ == "__main__":
    unittest.main()
