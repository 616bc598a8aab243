/* Formats values of metrics as text and as JSON, including unknown values and the PSNR of equal pictures. */
#include <math.h>
#include <stdio.h>

#include "apps/isocompare/isocompare.h"

double isocompare_metric_value(const iso_metric *metric, const iso_metrics *metrics) {
    const double value = iso_metric_value(metric, metrics);
    return iso_metric_is_infinite(metric, value) ? INFINITY : value;
}

double isocompare_psnr_value(double psnr) {
    return iso_metric_is_infinite(iso_metric_find("psnr"), psnr) ? INFINITY : psnr;
}

const char *isocompare_metric_text(double value, const char *format, char *text, size_t size) {
    if (isnan(value))
        snprintf(text, size, "-");
    else if (isinf(value))
        snprintf(text, size, "identical");
    else
        snprintf(text, size, format, value);
    return text;
}

void isocompare_put_metric(iso_json *json, const char *key, double value) {
    if (isinf(value))
        iso_json_string(json, key, "inf");
    else
        iso_json_real(json, key, value);
}
