/* module_broken: modules that test_module expects to be refused; BROKEN selects the defect. */
#include "grids/volume/module.h"

#define OTHER_ABI 1
#define OTHER_VERSION 2
#define EMPTY 3
#define ORPHAN 4 /* correct, but linked with a library that does not exist */

#if BROKEN == OTHER_ABI
extern const iso_module iso_module_table;
const iso_module iso_module_table = {.abi = ISO_MODULE_ABI + 1, .version = ISO_VERSION};
#elif BROKEN == OTHER_VERSION
extern const iso_module iso_module_table;
const iso_module iso_module_table = {.abi = ISO_MODULE_ABI, .version = "0." ISO_VERSION};
#elif BROKEN == EMPTY
extern const int iso_module_other_table;
const int iso_module_other_table = 1;
#else
int iso_module_gone(void);
int iso_module_orphan(void);
int iso_module_orphan(void) {
    return iso_module_gone();
}
#endif
