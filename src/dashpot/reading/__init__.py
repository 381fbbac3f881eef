"""Reading and writing of records: options, formats, text, columns, readers, and a writer."""
