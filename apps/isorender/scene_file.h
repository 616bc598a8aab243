/* scene_file: a picture as data. A scene is a JSON object with the input, every option that influences the
 * picture, by its long name, and a fingerprint of each file: in a file of its own (--save-scene), and in
 * every PNG (the text "Scene"). docs/scenes.md describes it, --schema prints its JSON schema. */
#ifndef ISO_APPS_ISORENDER_SCENE_FILE_H
#define ISO_APPS_ISORENDER_SCENE_FILE_H

#include "apps/isorender/isorender.h"

/* Command lines, each with its program's name first. */
typedef struct isorender_command {
    int argc;
    char **argv;      /* ends with NULL; owned, as the strings in `made` are */
    char **made;      /* ends with NULL */
    const char *path; /* of the scene's file; borrowed from the first command line */
} isorender_command;

typedef struct isorender_commands {
    isorender_command *items;
    int count;
} isorender_commands;

/* Makes a command line of each scene on a command line (an operand NAME.json that holds one, or --again): the
 * scene's options, its input, unless the command line has one, and then what else is on the command line,
 * which has the last word. None: there is no scene, or the command line is wrong. isorender_commands_free
 * when done. ISO_ERR_IO; ISO_ERR_FORMAT: no scene, or a file of the scene is another one; ISO_ERR_NOMEM. */
iso_status isorender_commands_make(int argc, char **argv, isorender_commands *commands, iso_error *error);
void isorender_commands_free(isorender_commands *commands);

/* Sets *text to the scene of a job as one line, for PNGs; the caller's: free(). NULL: it has more options
 * than ISORENDER_NOTED. ISO_ERR_NOMEM. */
iso_status isorender_scene_text(const isorender_job *job, char **text, iso_error *error);

/* Appends to `text`, of `size` bytes, the options of a job as a command line has them, as far as there is
 * room: those of its scene if it shares its view, else as they were given. */
void isorender_scene_command(const isorender_job *job, char *text, size_t size);

/* Writes the scene of a job with its camera and isovalues (--save-scene). ISO_ERR_WRITE, ISO_ERR_NOMEM;
 * ISO_ERR_LIMIT: more options than ISORENDER_NOTED. */
iso_status isorender_scene_save(const isorender_job *job, iso_error *error);

/* Prints the JSON schema of scenes. */
iso_status isorender_scene_print_schema(iso_error *error);

#endif
