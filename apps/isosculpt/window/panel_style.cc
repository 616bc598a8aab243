/* The panel's font, colours and sizes. */
#include <cstdio>
#include <cstring>

#include "apps/isosculpt/window/panel_parts.hpp"
#include "base/file.h"

static const float ROW_HEIGHT = 23; /* of widgets, at scale 1 */

/* ---- the font */

/* A font file that may be installed, and the height of its lines: some fonts are larger than others at the
 * same height. */
struct font_file {
    const char *path;
    float size;
};
static const font_file FONTS[] = {{"/usr/share/fonts/opentype/inter/Inter-Regular.otf", 15},
                                  {"/usr/share/fonts/inter/Inter-Regular.otf", 15},
                                  {"/usr/share/fonts/truetype/noto/NotoSans-Regular.ttf", 15},
                                  {"/usr/share/fonts/noto/NotoSans-Regular.ttf", 15},
                                  {"/usr/share/fonts/google-noto/NotoSans-Regular.ttf", 15},
                                  {"/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf", 14},
                                  {"/usr/share/fonts/dejavu-sans-fonts/DejaVuSans.ttf", 14},
                                  {"/usr/share/fonts/TTF/DejaVuSans.ttf", 14}};
static const float OWN_FONT_SIZE = 13, FONT_SIZE = 15;
static const size_t FONT_BYTES = 64u << 20; /* no font file is larger */

/* Whether the bytes begin as a TrueType or OpenType font does. Dear ImGui aborts the program for anything
 * else. */
static bool is_font(const std::vector<unsigned char> &bytes) {
    static const unsigned char kinds[][4] = {
        {0, 1, 0, 0}, {'O', 'T', 'T', 'O'}, {'t', 'r', 'u', 'e'}, {'t', 't', 'c', 'f'}};
    for (const auto &kind : kinds)
        if (bytes.size() > 1024 && std::memcmp(bytes.data(), kind, 4) == 0) return true;
    return false;
}

/* Reads a font file. ISO_ERR_IO, ISO_ERR_FORMAT. */
static iso_status read_font(const char *path, std::vector<unsigned char> *bytes, iso_error *error) {
    FILE *file;
    uint64_t size;
    ISO_TRY(iso_file_open(path, &file, &size, error));
    bytes->resize(size < FONT_BYTES ? (size_t)size : 0);
    const bool whole = !bytes->empty() && std::fread(bytes->data(), 1, bytes->size(), file) == bytes->size();
    std::fclose(file);
    if (!whole) return iso_fail(error, ISO_ERR_IO, "%s: cannot be read as a font", path);
    return is_font(*bytes) ? ISO_OK
                           : iso_fail(error, ISO_ERR_FORMAT, "%s: no TrueType or OpenType font", path);
}

iso_status panel_choose_font(const char *path, panel_font *font, iso_error *error) {
    *font = panel_font{};
    font->size = FONT_SIZE;
    if (path && std::strcmp(path, "builtin") == 0) return ISO_OK;
    if (path) return read_font(path, &font->bytes, error);
    for (const font_file &file : FONTS) {
        font->size = file.size;
        if (read_font(file.path, &font->bytes, nullptr) == ISO_OK) return ISO_OK;
        font->bytes.clear();
    }
    return ISO_OK;
}

/* Makes the letters. Returns false if the font file is none. */
static bool make_letters(const panel_font &font, float scale) {
    /* Latin, Greek, Cyrillic, dashes and quotation marks: names of files */
    static const ImWchar ranges[] = {0x20, 0x24f, 0x370, 0x52f, 0x2010, 0x2027, 0};
    ImFontAtlas *fonts = ImGui::GetIO().Fonts;
    ImFontConfig config;
    fonts->Clear();
    config.SizePixels = std::floor((font.bytes.empty() ? OWN_FONT_SIZE : font.size) * scale);
    config.FontDataOwnedByAtlas = false; /* Dear ImGui only reads it */
    if (font.bytes.empty())
        fonts->AddFontDefault(&config);
    else
        fonts->AddFontFromMemoryTTF(const_cast<unsigned char *>(font.bytes.data()), (int)font.bytes.size(),
                                    config.SizePixels, &config, ranges);
    return fonts->Build();
}

/* ---- colours and sizes */

static void set_colors() {
    const ImVec4 ground{0.125f, 0.133f, 0.149f, 1}, popup{0.157f, 0.169f, 0.188f, 1},
        frame{0.208f, 0.220f, 0.247f, 1}, frame_hovered{0.259f, 0.275f, 0.306f, 1},
        frame_active{0.306f, 0.325f, 0.361f, 1}, accent{0.216f, 0.478f, 0.890f, 1},
        accent_light{0.345f, 0.580f, 0.945f, 1}, line{0.30f, 0.32f, 0.35f, 0.6f},
        text{0.902f, 0.914f, 0.933f, 1}, faint{0.50f, 0.52f, 0.56f, 1};
    ImVec4 *colors = ImGui::GetStyle().Colors;
    ImGui::StyleColorsDark();
    colors[ImGuiCol_Text] = text;
    colors[ImGuiCol_TextDisabled] = faint;
    colors[ImGuiCol_WindowBg] = ground;
    colors[ImGuiCol_ChildBg] = ImVec4(0.098f, 0.106f, 0.118f, 1);
    colors[ImGuiCol_PopupBg] = popup;
    colors[ImGuiCol_Border] = colors[ImGuiCol_Separator] = line;
    colors[ImGuiCol_FrameBg] = colors[ImGuiCol_Button] = frame;
    colors[ImGuiCol_FrameBgHovered] = colors[ImGuiCol_ButtonHovered] = frame_hovered;
    colors[ImGuiCol_FrameBgActive] = colors[ImGuiCol_ButtonActive] = frame_active;
    colors[ImGuiCol_Header] = ImVec4(0.165f, 0.176f, 0.200f, 1);
    colors[ImGuiCol_HeaderHovered] = frame_hovered;
    colors[ImGuiCol_HeaderActive] = frame_active;
    colors[ImGuiCol_TitleBg] = colors[ImGuiCol_TitleBgActive] = popup;
    colors[ImGuiCol_CheckMark] = colors[ImGuiCol_SliderGrab] = colors[ImGuiCol_PlotHistogram] = accent;
    colors[ImGuiCol_SliderGrabActive] = accent_light;
    colors[ImGuiCol_TextSelectedBg] = ImVec4(accent.x, accent.y, accent.z, 0.5f);
    colors[ImGuiCol_ScrollbarBg] = ImVec4(0, 0, 0, 0);
    colors[ImGuiCol_TableRowBgAlt] = ImVec4(1, 1, 1, 0.03f);
    colors[ImGuiCol_TableHeaderBg] = colors[ImGuiCol_Header];
    colors[ImGuiCol_ModalWindowDimBg] = ImVec4(0, 0, 0, 0.5f);
}

bool panel_set_style(const panel_font &font, float scale) {
    ImGui::GetIO().IniFilename = nullptr;
    if (!make_letters(font, scale)) return false;
    ImGuiStyle &style = ImGui::GetStyle() = ImGuiStyle();
    set_colors();
    style.WindowPadding = ImVec2(12, 10);
    style.ItemSpacing = ImVec2(8, 5);
    style.ItemInnerSpacing = ImVec2(6, 4);
    style.FramePadding = ImVec2(8, 0);
    style.WindowRounding = style.PopupRounding = 8;
    style.FrameRounding = style.ChildRounding = style.GrabRounding = 4;
    style.ScrollbarRounding = 6;
    style.ScrollbarSize = 10;
    style.GrabMinSize = 12;
    style.WindowTitleAlign = ImVec2(0.5f, 0.5f);
    style.ScaleAllSizes(scale);
    style.FramePadding.y = std::floor((ROW_HEIGHT * scale - ImGui::GetIO().Fonts->Fonts[0]->FontSize) / 2);
    return true;
}
