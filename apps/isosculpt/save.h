/* save: the names of files that a sculpture is saved to, and saving in a background thread. The extension
 * decides what is written: a level set (.vdb) or a mesh (.stl, .ply, .obj). */
#ifndef ISO_APPS_ISOSCULPT_SAVE_H
#define ISO_APPS_ISOSCULPT_SAVE_H

#include "apps/isosculpt/document.h"
#include "base/c_linkage.h"

ISO_C_BEGIN

/* Whether a sculpture can be saved with this extension. */
bool isosculpt_can_save_as(const char *path);

/* The default target of a session that began with the file `source` (NULL: with a ball): a path that does not
 * exist yet, beside the source with .vdb for its extension; in the working directory, else in $HOME, where
 * the source's folder cannot be written or there is no source. */
void isosculpt_target_default(const char *source, char target[ISOSCULPT_PATH]);
/* Writes `path` with the extension .vdb to `target`, whether or not that file exists. */
void isosculpt_target_beside(const char *path, char target[ISOSCULPT_PATH]);
/* Writes `path` with another extension (such as ".png") to the result, with a number before it if such a file
 * exists. */
void isosculpt_path_unused(const char *path, const char *extension, char unused[ISOSCULPT_PATH]);
/* Writes `path` with its extension replaced by an ending (such as "-1.png"); returns false if the name is too
 * long. */
bool isosculpt_path_with_ending(const char *path, const char *ending, char changed[ISOSCULPT_PATH]);

/* Checks whether the document may be saved to `path`. ISO_ERR_USAGE: wrong extension, or the file is the one
 * that the session began with; ISO_ERR_WRITE: a folder, not a regular file, or read-only. *replaces: a file
 * exists that this session did not write; ask the user. */
iso_status isosculpt_document_check_target(const isosculpt_document *document, const char *path,
                                           bool *replaces, iso_error *error);

typedef struct isosculpt_save_opts {
    const char *path;   /* copied; NULL: the document's target */
    bool is_export;     /* write a copy: the document's target and its saved state stay unchanged */
    iso_rgb color;      /* of a mesh's vertices where nothing is painted, if something is */
    bool closed;        /* a mesh is capped where the border of the grid cuts the solid */
    void (*wake)(void); /* isosculpt_task_start */
} isosculpt_save_opts;

/* Starts to save a snapshot of the field in a background thread; editing may go on. The new file appears only
 * when it is complete, and the old file becomes PATH.bak, or PATH.bak-2 and so on if a file that this session
 * did not put there has that name. Unless it is an export, `path` becomes the
 * document's target. ISO_ERR_USAGE while a save is running or a stroke is drawn; errors of
 * isosculpt_document_check_target; ISO_ERR_NOMEM. */
iso_status isosculpt_document_save(isosculpt_document *document, const isosculpt_save_opts *opts,
                                   iso_error *error);
/* The running save, for its progress or to cancel it (no new file appears then); NULL: none is running. */
isosculpt_task *isosculpt_document_save_task(const isosculpt_document *document);

typedef enum isosculpt_save_state {
    ISOSCULPT_SAVE_IDLE,
    ISOSCULPT_SAVE_RUNNING,
    ISOSCULPT_SAVE_DONE
} isosculpt_save_state;
/* The state of the save. Returns ISOSCULPT_SAVE_DONE once for each save, with its result in *status and
 * *error (either may be NULL); document->saved_as names the file, document->saved_open_edges says whether its
 * mesh is open, document->saved_nothing whether there is no solid in it. `wait`: first waits until the save
 * is done. */
isosculpt_save_state isosculpt_document_poll_save(isosculpt_document *document, bool wait, iso_status *status,
                                                  iso_error *error);

/* One line that says how many edges of the written mesh are open, why, and that --closed caps them. */
void isosculpt_mesh_open_note(size_t open_edges, char *text, size_t size);

ISO_C_END
#endif
