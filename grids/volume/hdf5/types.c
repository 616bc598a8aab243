/* types: which types of values of HDF5 files are read, and as what. */
#include "grids/volume/hdf5/types.h"

#include <stdio.h>

static const iso_scalar integers[4][2] = {{ISO_SCALAR_UINT8, ISO_SCALAR_INT8},
                                          {ISO_SCALAR_UINT16, ISO_SCALAR_INT16},
                                          {ISO_SCALAR_UINT32, ISO_SCALAR_INT32},
                                          {ISO_SCALAR_UINT64, ISO_SCALAR_INT64}};

/* IEEE 754 with 16 bits, which libhdf5 1.10 has no name for; h5py makes it the same way. */
static hid_t make_half(void) {
    const hid_t type = H5Tcopy(H5T_NATIVE_FLOAT);
    H5Tset_fields(type, 15, 10, 5, 0, 10);
    H5Tset_size(type, 2);
    H5Tset_ebias(type, 15);
    return type;
}

static hid_t native_type(iso_scalar scalar) {
    const hid_t types[] = {H5T_NATIVE_UINT8,  H5T_NATIVE_INT8,  H5T_NATIVE_UINT16, H5T_NATIVE_INT16,
                           H5T_NATIVE_UINT32, H5T_NATIVE_INT32, H5T_NATIVE_UINT64, H5T_NATIVE_INT64,
                           H5T_NATIVE_FLOAT,  H5T_NATIVE_DOUBLE};
    return scalar == ISO_SCALAR_HALF ? make_half() : types[scalar];
}

static bool integer_of(hid_t type, iso_hdf5_array *array) {
    const size_t size = H5Tget_size(type), precision = H5Tget_precision(type);
    int power = 0;
    while (power < 3 && precision > (size_t)8 << power) power++;
    array->scalar = integers[power][H5Tget_sign(type) == H5T_SGN_2];
    if (precision == 8 * size && size == iso_scalar_size(array->scalar)) return true;
    array->by_library = true;
    snprintf(array->special, sizeof array->special, "integers of %zu bits in %zu bytes", precision, size);
    return precision >= 1 && precision <= 64;
}

static bool is_scalar(hid_t type, iso_scalar scalar) {
    const hid_t same = H5Tcopy(native_type(scalar));
    return H5Tset_order(same, H5Tget_order(type)) >= 0 && H5Tequal(type, same) > 0;
}

static bool float_of(hid_t type, iso_hdf5_array *array) {
    static const iso_scalar scalars[] = {ISO_SCALAR_HALF, ISO_SCALAR_FLOAT, ISO_SCALAR_DOUBLE};
    size_t sign, exponent, exponent_bits = 0, fraction, fraction_bits = 0;
    for (size_t i = 0; i < sizeof scalars / sizeof *scalars; i++)
        if (is_scalar(type, scalars[i])) {
            array->scalar = scalars[i];
            return true;
        }
    H5Tget_fields(type, &sign, &exponent, &exponent_bits, &fraction, &fraction_bits);
    snprintf(array->special, sizeof array->special,
             "floats of %zu bytes, with %zu bits for the exponent and %zu for the fraction",
             H5Tget_size(type), exponent_bits, fraction_bits);
    return false;
}

/* Booleans are an enumeration of integers (h5py). */
static hid_t type_of_numbers(hid_t dataset) {
    const hid_t type = H5Dget_type(dataset);
    return H5Tget_class(type) == H5T_ENUM ? H5Tget_super(type) : type;
}

bool iso_hdf5_read_type(hid_t dataset, iso_hdf5_array *array) {
    const hid_t type = type_of_numbers(dataset);
    const H5T_class_t kind = H5Tget_class(type);
    if (kind != H5T_INTEGER && kind != H5T_BITFIELD && kind != H5T_FLOAT) return false;
    array->big_endian = H5Tget_order(type) == H5T_ORDER_BE;
    const bool is_read = kind == H5T_FLOAT ? float_of(type, array) : integer_of(type, array);
    array->element_bytes = iso_scalar_size(array->scalar);
    return is_read;
}

hid_t iso_hdf5_memory_type(hid_t dataset) {
    iso_hdf5_array array = {0};
    if (!iso_hdf5_read_type(dataset, &array)) return -1;
    if (H5Tget_class(type_of_numbers(dataset)) != H5T_BITFIELD) return native_type(array.scalar);
    /* libhdf5 does not convert fields of bits to integers */
    return array.element_bytes == 1   ? H5T_NATIVE_B8
           : array.element_bytes == 2 ? H5T_NATIVE_B16
           : array.element_bytes == 4 ? H5T_NATIVE_B32
                                      : H5T_NATIVE_B64;
}
