find_package(ITK REQUIRED COMPONENTS ITKCommon ITKIONIFTI ITKIONRRD ITKIOMeta)
find_package(ZLIB REQUIRED)
find_package(Threads REQUIRED)
find_library(NIFTIIO_LIBRARY niftiio REQUIRED)

add_library(podm_image_io STATIC label_names.cpp label_selection.cpp phantom.cpp phantom_abdomen.cpp raw_image.cpp read_bytes.cpp
                                 read_image.cpp read_inr.cpp read_itk.cpp read_libnifti.cpp write_nifti.cpp)
target_include_directories(podm_image_io SYSTEM PRIVATE ${ITK_INCLUDE_DIRS})
target_link_libraries(podm_image_io PUBLIC podm_geometry PRIVATE podm_flags ${ITK_LIBRARIES} ${NIFTIIO_LIBRARY}
                                                                 ZLIB::ZLIB Threads::Threads)
