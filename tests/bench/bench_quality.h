/* bench_quality: ./run bench quality, how near the methods come to the truth. */
#ifndef ISO_TESTS_BENCH_QUALITY_H
#define ISO_TESTS_BENCH_QUALITY_H

#ifdef __cplusplus
extern "C" {
#endif

/* The whole program, from the command line behind the name `quality`; the exit status. */
int bench_quality(int argc, char **argv);

#ifdef __cplusplus
}
#endif
#endif
