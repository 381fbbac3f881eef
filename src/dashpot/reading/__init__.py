"""From files to records and back: options, formats, text, columns, readers, and one writer."""
