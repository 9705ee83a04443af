// Included first in builds with clang: Debian's ITK headers name GCC as the one compiler they know, and what they
// would say of clang is the same.
#pragma once
#if defined(__cplusplus) && defined(__clang__)
#pragma clang diagnostic push
#pragma clang diagnostic ignored "-Wbuiltin-macro-redefined"
#pragma push_macro("__clang__")
#undef __clang__
#include <ITK-5.2/itk_compiler_detection.h>
#pragma pop_macro("__clang__")
#pragma clang diagnostic pop
#endif
