/* scale: overrides functions of GLFW (by LD_PRELOAD), so that a test can change the content scale of the
 * screen, which never changes under X11. The scale is the number in the file $ISO_TEST_SCALE; the program's
 * callback is called when it changes. */
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <GLFW/glfw3.h>

static GLFWwindow *window;
static GLFWwindowcontentscalefun listener;
static float now = 1;

static void look(void) {
    float scale = now;
    FILE *file = fopen(getenv("ISO_TEST_SCALE"), "r");
    if (!file) return;
    const int found = fscanf(file, "%f", &scale);
    fclose(file);
    if (found != 1 || scale == now) return;
    now = scale;
    if (listener) listener(window, scale, scale);
}

/* Sets a function pointer by dlsym. By memcpy, because C has no conversion from object to function pointers.
 */
#define FIND(name)                                                                                           \
    do {                                                                                                     \
        void *found = dlsym(RTLD_NEXT, __func__);                                                            \
        memcpy(&(name), &found, sizeof(name));                                                               \
    } while (0)

void glfwGetWindowContentScale(GLFWwindow *of, float *x, float *y) {
    (void)of;
    *x = *y = now;
}

GLFWwindowcontentscalefun glfwSetWindowContentScaleCallback(GLFWwindow *of, GLFWwindowcontentscalefun heard) {
    window = of;
    listener = heard;
    return NULL;
}

void glfwPollEvents(void) {
    void (*poll)(void);
    FIND(poll);
    poll();
    look();
}

void glfwWaitEventsTimeout(double seconds) {
    void (*wait)(double);
    FIND(wait);
    wait(seconds);
    look();
}
