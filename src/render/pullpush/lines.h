/* lines: draws lines in the pyramid of pull-push, as tubes or ribbons (Marroquim, Kraus and Cavalcanti 2008,
 * section 4): the method of the paper, to be compared with exact solids (render/shapes).
 *
 * Each segment becomes line fragments, one for each pixel of the base level along the segment's major axis,
 * with the attributes of that place of the segment; pull and push fill its width, as they fill the gaps
 * between points. A fragment is a disc: of tubes one that faces the eye, of ribbons one in the plane of the
 * ribbon. What is not the paper's:
 * - fragments are not averaged: a pixel of a level shows one, and one behind it, and pull and push choose
 *   those that are nearest to its centre (line_levels.c), so that lines turn in the picture without horns.
 *   Ribbons in a pyramid of several sets (sets.h) are averaged, and their ellipses are longer on coarse
 *   levels;
 * - attributes are interpolated with perspective; normals of ribbons are made perpendicular to the segment;
 * - discs are not widened or filtered. Those of ribbons are short along the line, and those of ribbons and of
 *   flat caps get shorter towards the ends of a line, so that it ends there;
 * - vertices are dropped where neither the line nor its outline moves by more than opts.drop_pixels; the
 *   paper suggests to drop some, and does not say when;
 * - each sample lies where its ray meets the tube's side or round end, or the plane of the ribbon, and gets
 *   the normal there, for shading with any lights.
 * With ISO_LINE_ILLUMINATED tubes get the paper's normals instead (section 4.2, figure 11): the direction to
 * the key light, projected onto the plane perpendicular to the tangent. A tube is then as bright across its
 * whole width as its brightest place in that light, which suits lines of few pixels. Where this place is on
 * the side that the eye does not see, the two-sided shading leaves the key light out. */
#ifndef ISO_RENDER_PULLPUSH_LINES_H
#define ISO_RENDER_PULLPUSH_LINES_H

#include "render/pullpush/pullpush.h"
#include "render/shapes/shapes.h"

/* Lines that are prepared for drawing. Immutable; any number of threads may draw them at the same time. */
typedef struct iso_pyramid_lines iso_pyramid_lines;

/* Prepares lines as iso_shapes_from_lines does, with the same options; those for glyphs do not count. The
 * arrays of `lines` are borrowed until iso_pyramid_lines_destroy. Takes 18 bytes a vertex. Errors: as there.
 */
iso_status iso_pyramid_lines_create(const iso_lines *lines, const iso_shapes_opts *opts,
                                    iso_pyramid_lines **made, iso_error *error);
void iso_pyramid_lines_destroy(iso_pyramid_lines *lines);

/* Draws lines into the gbuffer, as iso_draw_pullpush draws points, in a pyramid of their own: with what else
 * is in the gbuffer they are composited by depth. A line is at least a pixel wide, whatever its least width.
 * Writes colours, but no elements. `workspace` NULL: made for the call. ISO_ERR_NOMEM. */
iso_status iso_draw_pyramid_lines(const iso_target *target, const iso_pyramid_lines *lines,
                                  iso_pullpush *workspace, iso_error *error);

#endif
