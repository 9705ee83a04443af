add_library(podm_isosurface STATIC brick_distances.cpp brick_features.cpp feature_transform.cpp graded_grid.cpp
                                   interface_blur.cpp interface_distance.cpp interface_shift.cpp isosurface.cpp
                                   isosurface_block.cpp isosurface_closest.cpp isosurface_cubic.cpp isosurface_trace.cpp
                                   label_volumes.cpp scalar_grid.cpp smooth_interfaces.cpp surface_masks.cpp
                                   surface_tree.cpp working_frame.cpp)
target_link_libraries(podm_isosurface PUBLIC podm_geometry podm_runtime Threads::Threads
                      PRIVATE fmt::fmt podm_flags)

podm_add_test(isosurface_tests
              SOURCES tests/test_feature_transform.cpp tests/test_isosurface.cpp tests/test_smooth_interfaces.cpp
                      tests/test_surface_tree.cpp
                      tests/isosurface_reference.cpp
              LIBS podm_isosurface)

podm_add_test(size_grid_tests
              SOURCES tests/test_graded_grid.cpp tests/test_interface_distance.cpp tests/test_scalar_grid.cpp
              LIBS podm_isosurface)
