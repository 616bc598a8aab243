/* save: the file that a sculpture is saved to, and writing it beside the work. By its extension a file is a
 * level set (.vdb) or a mesh (.stl, .ply, .obj). */
#ifndef ISO_APPS_ISOSCULPT_SAVE_H
#define ISO_APPS_ISOSCULPT_SAVE_H

#include "apps/isosculpt/document.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Whether the extension is one that a sculpture can be saved with. */
bool isosculpt_can_save_as(const char *path);

/* A whole path for a sculpture that began with the file `source` (NULL: with none), which is not there yet:
 * beside the source with .vdb; where that folder cannot be written, or without a source, in the working
 * directory, else in $HOME. */
void isosculpt_target_default(const char *source, char target[ISOSCULPT_PATH]);
/* The same with .vdb in place of `path`'s extension, whether it is there or not. */
void isosculpt_target_beside(const char *path, char target[ISOSCULPT_PATH]);
/* `target` with another extension, and a number before it when that is there already. */
void isosculpt_target_free(const char *target, const char *extension, char path[ISOSCULPT_PATH]);
/* `target` with another ending in place of its extension ("-1.png"); false: the name is too long. */
bool isosculpt_target_with(const char *target, const char *ending, char path[ISOSCULPT_PATH]);

/* Whether saving to `path` is allowed. ISO_ERR_USAGE: the extension, or the file is the one that the session
 * began with; ISO_ERR_WRITE: a folder, no regular file, or read-only. *replaces: there is a file that this
 * session did not write, so that its user has to be asked. */
iso_status isosculpt_document_check_target(const isosculpt_document *document, const char *path,
                                           bool *replaces, iso_error *error);

typedef struct isosculpt_save_opts {
    const char *path;   /* copied; NULL: the desk's target */
    bool is_export;     /* a copy for others: the target and what counts as saved stay as they are */
    void (*wake)(void); /* isosculpt_task_start */
} isosculpt_save_opts;

/* Begins to save the field as it is, in a thread of its own: the file appears whole, what was there becomes
 * PATH.bak. A path becomes the desk's target. ISO_ERR_USAGE while a save is running or a stroke is drawn, or
 * as isosculpt_document_check_target; ISO_ERR_NOMEM. */
iso_status isosculpt_document_save(isosculpt_document *document, const isosculpt_save_opts *opts,
                                   iso_error *error);
/* The save that is running, to ask or to cancel: then there is no new file. NULL: none. */
isosculpt_task *isosculpt_document_save_task(const isosculpt_document *document);

typedef enum isosculpt_saving {
    ISOSCULPT_SAVE_IDLE,
    ISOSCULPT_SAVE_RUNNING,
    ISOSCULPT_SAVE_DONE
} isosculpt_saving;
/* How the save stands; DONE once, with *status and *error its outcome; desk->saved_as names the file. `wait`:
 * until it is done. */
isosculpt_saving isosculpt_document_saving(isosculpt_document *document, bool wait, iso_status *status,
                                           iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
