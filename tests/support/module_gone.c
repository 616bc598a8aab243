/* module_gone: the library with which a module of module_broken.c is linked, and which is then removed. */
int iso_module_gone(void);

int iso_module_gone(void) {
    return 1;
}
