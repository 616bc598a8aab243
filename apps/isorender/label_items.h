/* label_items: the words of --label: which labels are drawn, and how. */
#ifndef ISO_APPS_ISORENDER_LABEL_ITEMS_H
#define ISO_APPS_ISORENDER_LABEL_ITEMS_H

#include "apps/common/options.h"
#include "scene/segmentation.h"

/* Each text is a list WHICH[:OPACITY][:COLOR],.. where WHICH is a value, a range of values as 3-7, a name
 * (in either case, with * for anything) or all. ISO_ERR_USAGE. */
iso_status isorender_label_items_check(const iso_texts *texts, iso_error *error);
/* Whether an opacity is given that is between 0 and 1. */
bool isorender_label_items_translucent(const iso_texts *texts);
/* Sets colours and opacities of the labels that are meant; others get opacity 0, if there are any texts.
 * items: of each label. ISO_ERR_USAGE: a label that is not there. */
iso_status isorender_label_items_apply(const iso_texts *texts, const iso_labels *labels,
                                       iso_drawn_label *items, iso_error *error);

#endif
