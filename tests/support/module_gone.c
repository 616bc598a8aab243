/* module_gone: the library that a module of module_broken.c is linked with and cannot find. */
int iso_module_gone(void);

int iso_module_gone(void) {
    return 1;
}
