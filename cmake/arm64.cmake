# Toolchain file for Debian's cross compiler to arm64. PODM_SYSROOT is a folder of unpacked arm64 packages
# (ci/arm64.sh). Programs for arm64 that the build or ctest runs are run by qemu.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_TRY_COMPILE_PLATFORM_VARIABLES PODM_SYSROOT)
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-aarch64-static -L ${PODM_SYSROOT})
set(CMAKE_SYSROOT ${PODM_SYSROOT})
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(CMAKE_LIBRARY_PATH /usr/lib/aarch64-linux-gnu/hdf5/serial)  # FindHDF5 asks this machine's h5cc for the folder
set(CMAKE_DISABLE_FIND_PACKAGE_MPI ON)  # the compiler wrappers of MPI are programs of this machine
set(ENV{PKG_CONFIG_SYSROOT_DIR} ${PODM_SYSROOT})
set(ENV{PKG_CONFIG_LIBDIR} ${PODM_SYSROOT}/usr/lib/aarch64-linux-gnu/pkgconfig:${PODM_SYSROOT}/usr/share/pkgconfig)
