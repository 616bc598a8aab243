/* exponential: the logarithm. */
#include "base/exponential.h"

double iso_log2(double x) {
    /* x = m * 2^exponent with m in [sqrt(1/2), sqrt(2)); ln m = 2 atanh(z) with z = (m - 1) / (m + 1), as a
     * power series; z^2 < 0.0295, so that 9 terms leave less than 1e-16 */
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    int exponent = (int)(bits >> 52) - 1023;
    bits = (bits & 0xfffffffffffffu) | (uint64_t)1023 << 52;
    double m;
    memcpy(&m, &bits, sizeof m);
    if (m >= 1.4142135623730951) {
        m *= 0.5;
        exponent++;
    }
    const double z = (m - 1) / (m + 1), square = z * z;
    double sum = 0;
    for (int power = 21; power >= 1; power -= 2) sum = sum * square + 1.0 / power;
    return exponent + 2.8853900817779268 * (z * sum); /* 2 / ln 2 */
}
