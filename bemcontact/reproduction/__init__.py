"""The five problems of [SS92], carried out and put beside what the paper says of them."""
