// The module that uses Cairo and Pango, loaded when the first figure is drawn.
#include "plots/drawing_module.hpp"

#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <pango/pangocairo.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <new>
#include <numbers>
#include <stdexcept>

namespace cloudbow {
namespace {

constexpr const char* font_family = "DejaVu Sans";

template <auto release>
struct Release {
  template <class Object>
  void operator()(Object* object) const {
    release(object);
  }
};
using Surface = std::unique_ptr<cairo_surface_t, Release<cairo_surface_destroy>>;
using Context = std::unique_ptr<cairo_t, Release<cairo_destroy>>;
using Layout = std::unique_ptr<PangoLayout, Release<g_object_unref>>;
using Font = std::unique_ptr<PangoFontDescription, Release<pango_font_description_free>>;

void check(cairo_status_t status) {
  if (status == CAIRO_STATUS_NO_MEMORY) throw std::bad_alloc();
  if (status != CAIRO_STATUS_SUCCESS) throw std::runtime_error(cairo_status_to_string(status));
}

/// The same for every user and display, so that a figure does not depend on their settings.
void set_font_options(PangoContext* context) {
  cairo_font_options_t* options = cairo_font_options_create();
  cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
  cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE);
  cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
  pango_cairo_context_set_font_options(context, options);
  cairo_font_options_destroy(options);
  pango_context_set_round_glyph_positions(context, FALSE);
}

Layout make_layout(cairo_t* cairo, const DrawnText& text) {
  Layout layout(pango_cairo_create_layout(cairo));
  set_font_options(pango_layout_get_context(layout.get()));
  pango_layout_context_changed(layout.get());
  const Font font(pango_font_description_from_string(font_family));
  pango_font_description_set_absolute_size(font.get(), text.size * PANGO_SCALE);
  pango_layout_set_font_description(layout.get(), font.get());
  const PangoAlignment alignment = text.anchor == TextAnchor::left     ? PANGO_ALIGN_LEFT
                                   : text.anchor == TextAnchor::centre ? PANGO_ALIGN_CENTER
                                                                       : PANGO_ALIGN_RIGHT;
  pango_layout_set_alignment(layout.get(), alignment);
  pango_layout_set_markup(layout.get(), text.markup.c_str(), -1);
  if (text.max_width > 0) {
    pango_layout_set_width(layout.get(), static_cast<int>(text.max_width * PANGO_SCALE));
    pango_layout_set_wrap(layout.get(), PANGO_WRAP_WORD_CHAR);
    if (text.max_lines > 0) {
      pango_layout_set_height(layout.get(), -text.max_lines);
      pango_layout_set_ellipsize(layout.get(), PANGO_ELLIPSIZE_END);
    }
  }
  return layout;
}

TextSize size_of(PangoLayout* layout) {
  PangoRectangle logical;
  pango_layout_get_extents(layout, nullptr, &logical);
  return {static_cast<double>(logical.width) / PANGO_SCALE, static_cast<double>(logical.height) / PANGO_SCALE,
          pango_layout_get_line_count(layout)};
}

std::string find_fonts() {
  PangoFontFamily** families = nullptr;
  int count = 0;
  pango_font_map_list_families(pango_cairo_font_map_get_default(), &families, &count);
  g_free(families);
  return count > 0 ? "" : "this machine has no font that fontconfig finds";
}

TextSize measure(const DrawnText& text) {
  const Surface surface(cairo_recording_surface_create(CAIRO_CONTENT_COLOR, nullptr));
  const Context cairo(cairo_create(surface.get()));
  return size_of(make_layout(cairo.get(), text).get());
}

class Painter {
 public:
  /// @param repeats_pixels because a viewer of the format would blur a picture of few pixels
  Painter(cairo_t* cairo, bool repeats_pixels) : cairo_(cairo), repeats_pixels_(repeats_pixels) {
    cairo_set_line_cap(cairo_, CAIRO_LINE_CAP_ROUND);
    cairo_set_line_join(cairo_, CAIRO_LINE_JOIN_ROUND);
  }

  void operator()(const DrawnLine& line) const {
    if (line.points.empty()) return;
    cairo_save(cairo_);
    clip(line.clip);
    set_colour(line.stroke.colour, line.stroke.opacity);
    cairo_set_line_width(cairo_, line.stroke.width);
    if (!line.stroke.dash.empty()) {
      cairo_set_line_cap(cairo_, CAIRO_LINE_CAP_BUTT);
      cairo_set_dash(cairo_, line.stroke.dash.data(), static_cast<int>(line.stroke.dash.size()), 0);
    }
    cairo_move_to(cairo_, line.points.front().x, line.points.front().y);
    for (const auto& [x, y] : line.points) cairo_line_to(cairo_, x, y);
    cairo_stroke(cairo_);
    cairo_restore(cairo_);
  }

  void operator()(const DrawnArea& area) const {
    set_colour(area.colour, area.opacity);
    cairo_rectangle(cairo_, area.box.left, area.box.top, area.box.width(), area.box.height());
    cairo_fill(cairo_);
  }

  void operator()(const DrawnDisc& disc) const {
    cairo_save(cairo_);
    clip(disc.clip);
    set_colour(disc.colour, 1);
    cairo_arc(cairo_, disc.centre.x, disc.centre.y, disc.radius, 0, 2 * std::numbers::pi);
    cairo_fill(cairo_);
    cairo_restore(cairo_);
  }

  void operator()(const DrawnPicture& picture) const {
    const int repeats_x = repeats(picture.box.width(), picture.width);
    const int repeats_y = repeats(picture.box.height(), picture.height);
    const int width = repeats_x * picture.width, height = repeats_y * picture.height;
    const Surface surface(cairo_image_surface_create(CAIRO_FORMAT_ARGB32, width, height));
    check(cairo_surface_status(surface.get()));
    unsigned char* const pixels = cairo_image_surface_get_data(surface.get());
    const auto stride = static_cast<std::ptrdiff_t>(cairo_image_surface_get_stride(surface.get()));
    for (int y = 0; y < height; ++y) {
      auto* out = reinterpret_cast<std::uint32_t*>(pixels + y * stride);
      for (int x = 0; x < width; ++x) {
        const auto cell = static_cast<std::size_t>(y / repeats_y) * static_cast<std::size_t>(picture.width) +
                          static_cast<std::size_t>(x / repeats_x);
        out[x] = premultiplied(&picture.rgba[4 * cell]);
      }
    }
    cairo_surface_mark_dirty(surface.get());
    cairo_save(cairo_);
    cairo_translate(cairo_, picture.box.left, picture.box.top);
    cairo_scale(cairo_, picture.box.width() / width, picture.box.height() / height);
    cairo_set_source_surface(cairo_, surface.get(), 0, 0);
    cairo_pattern_set_filter(cairo_get_source(cairo_), CAIRO_FILTER_NEAREST);
    cairo_rectangle(cairo_, 0, 0, width, height);
    cairo_fill(cairo_);
    cairo_restore(cairo_);
  }

  void operator()(const DrawnText& text) const {
    cairo_save(cairo_);
    cairo_translate(cairo_, text.place.x, text.place.y);
    if (text.turn == TextTurn::upwards) cairo_rotate(cairo_, -std::numbers::pi / 2);
    const Layout layout = make_layout(cairo_, text);
    const TextSize size = size_of(layout.get());
    const double share = text.anchor == TextAnchor::left ? 0 : text.anchor == TextAnchor::centre ? 0.5 : 1;
    const double width = text.max_width > 0 ? text.max_width : size.width;
    double top = 0;
    if (text.hold == TextHold::middle) {
      // Half the height of a capital above the baseline of one line; the middle of several.
      constexpr double capital = 0.729;  // of the font's size
      const double baseline = static_cast<double>(pango_layout_get_baseline(layout.get())) / PANGO_SCALE;
      top = size.lines > 1 ? -0.5 * size.height : 0.5 * capital * text.size - baseline;
    }
    set_colour(text.colour, 1);
    cairo_move_to(cairo_, -share * width, top);
    pango_cairo_show_layout(cairo_, layout.get());
    cairo_restore(cairo_);
  }

 private:
  int repeats(double points, int pixels) const {
    constexpr double fine = 4;  // pixels per point
    return repeats_pixels_ ? std::max(1, static_cast<int>(std::ceil(fine * points / pixels))) : 1;
  }

  /// The pixel as Cairo takes it: colours multiplied by alpha, which is 0 or 255.
  static std::uint32_t premultiplied(const std::uint8_t* rgba) {
    if (rgba[3] == 0) return 0;
    return 0xff000000U | static_cast<std::uint32_t>(rgba[0]) << 16U | static_cast<std::uint32_t>(rgba[1]) << 8U |
           static_cast<std::uint32_t>(rgba[2]);
  }

  void set_colour(const PlotColour& colour, double opacity) const {
    cairo_set_source_rgba(cairo_, colour[0] / 255.0, colour[1] / 255.0, colour[2] / 255.0, opacity);
  }

  void clip(const std::optional<PlotBox>& box) const {
    if (!box) return;
    cairo_rectangle(cairo_, box->left, box->top, box->width(), box->height());
    cairo_clip(cairo_);
  }

  cairo_t* cairo_;
  bool repeats_pixels_;
};

cairo_status_t append(void* bytes, const unsigned char* data, unsigned int length) {
  auto* all = static_cast<std::vector<std::uint8_t>*>(bytes);
  all->insert(all->end(), data, data + length);
  return CAIRO_STATUS_SUCCESS;
}

/// The drawing as commands, in points. Text laid out for pixels has superscripts of a wrong size in Pango 1.50.
Surface record(const Drawing& drawing, DrawingFormat format) {
  const cairo_rectangle_t page{0, 0, drawing.width, drawing.height};
  Surface surface(cairo_recording_surface_create(CAIRO_CONTENT_COLOR_ALPHA, &page));
  const Context cairo(cairo_create(surface.get()));
  const Painter painter(cairo.get(), format == DrawingFormat::svg);
  for (const Shape& shape : drawing.shapes) std::visit(painter, shape);
  check(cairo_status(cairo.get()));
  return surface;
}

Surface make_surface(const Drawing& drawing, DrawingFormat format, double scale, std::vector<std::uint8_t>& bytes) {
  switch (format) {
    case DrawingFormat::svg:
      return Surface(cairo_svg_surface_create_for_stream(append, &bytes, drawing.width, drawing.height));
    case DrawingFormat::pdf: {
      Surface surface(cairo_pdf_surface_create_for_stream(append, &bytes, drawing.width, drawing.height));
      cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_TITLE, drawing.title.c_str());
      // No date: the same figure has the same bytes.
      cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATE_DATE, "");
      return surface;
    }
    case DrawingFormat::png:
      break;
  }
  return Surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, static_cast<int>(std::lround(scale * drawing.width)),
                                            static_cast<int>(std::lround(scale * drawing.height))));
}

std::vector<std::uint8_t> paint(const Drawing& drawing, DrawingFormat format, double scale) {
  std::vector<std::uint8_t> bytes;
  const Surface recorded = record(drawing, format);
  const Surface surface = make_surface(drawing, format, scale, bytes);
  check(cairo_surface_status(surface.get()));
  {
    const Context cairo(cairo_create(surface.get()));
    // The page may end within a pixel.
    cairo_set_source_rgb(cairo.get(), 1, 1, 1);
    cairo_paint(cairo.get());
    cairo_scale(cairo.get(), scale, scale);
    cairo_set_source_surface(cairo.get(), recorded.get(), 0, 0);
    cairo_paint(cairo.get());
    check(cairo_status(cairo.get()));
  }
  if (format == DrawingFormat::png) check(cairo_surface_write_to_png_stream(surface.get(), append, &bytes));
  cairo_surface_finish(surface.get());
  check(cairo_surface_status(surface.get()));
  return bytes;
}

}  // namespace
}  // namespace cloudbow

extern "C" const cloudbow::DrawingModule cloudbow_drawing_module{cloudbow::find_fonts, cloudbow::measure,
                                                                 cloudbow::paint};
