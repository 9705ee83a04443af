find_package(ITK REQUIRED COMPONENTS ITKCommon ITKIONRRD ITKIOMeta)
find_package(ZLIB REQUIRED)
podm_note_library(podm ITK ${ITK_VERSION})
podm_note_library(podm zlib ${ZLIB_VERSION_STRING})
find_package(Threads REQUIRED)
find_library(NIFTIIO_LIBRARY niftiio REQUIRED)

add_library(podm_image_io STATIC components.cpp index_voxels.cpp input_file.cpp islands.cpp label_names.cpp
                                 label_selection.cpp phantom.cpp phantom_abdomen.cpp phantom_shapes.cpp raw_image.cpp
                                 read_image.cpp read_inr.cpp read_itk.cpp read_nifti.cpp read_size_image.cpp thin_parts.cpp
                                 voxel_data.cpp write_nifti.cpp)
podm_unite(podm_image_io images components.cpp index_voxels.cpp input_file.cpp islands.cpp label_names.cpp phantom.cpp
           phantom_abdomen.cpp phantom_shapes.cpp raw_image.cpp read_image.cpp read_inr.cpp read_size_image.cpp
           write_nifti.cpp)
target_include_directories(podm_image_io SYSTEM PRIVATE ${ITK_INCLUDE_DIRS})
target_link_libraries(podm_image_io PUBLIC podm_geometry PRIVATE podm_flags podm_files ${ITK_LIBRARIES} ${NIFTIIO_LIBRARY}
                                                                 ZLIB::ZLIB Threads::Threads)

podm_add_test(image_io_tests
              SOURCES tests/test_components.cpp tests/test_islands.cpp tests/test_label_names.cpp tests/test_label_selection.cpp tests/test_phantom.cpp
                      tests/test_read_image_formats.cpp tests/test_read_image_real.cpp
                      tests/test_read_image_refused.cpp tests/test_read_size_image.cpp tests/test_thin_parts.cpp
                      tests/test_write_nifti.cpp
              LIBS podm_image_io ZLIB::ZLIB)

podm_add_fuzzer(fuzz_read_image LIBS podm_image_io LEARN podm_image_io)
podm_add_fuzzer(fuzz_label_options LIBS podm_image_io)
